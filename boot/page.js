// Starts the page. `cargo xtask build` replaces the names in double braces.

const wasmUrl = new URL("./{{wasm}}", import.meta.url);

// The Trusted Types policy that index.html requires for markup and workers. It refuses elements that can load or
// run something, and scripts from other folders.
const loads = /<\s*(script|iframe|frame|object|embed|base|meta|link|form)\b/i;
globalThis.trustedTypes?.createPolicy("default", {
  createHTML: (html) => (loads.test(html) ? null : html),
  createScriptURL: (url) => {
    const { origin, pathname } = new URL(url, import.meta.url);
    const folder = new URL("./", import.meta.url);
    return origin === folder.origin && pathname.startsWith(folder.pathname) ? url : null;
  },
});

let loaded = false;

// Shows an error that happens before the Rust code runs. Nothing else can show it then.
function explain(error) {
  console.error(error);
  const words = document.createElement("p");
  words.setAttribute("role", "alert");
  if (typeof WebAssembly !== "object") {
    words.textContent =
      "MotorLink needs WebAssembly. It is missing or turned off in this browser. " +
      "Open this page in a current Chrome, Edge or Firefox.";
  } else if (loaded) {
    words.textContent =
      "MotorLink loaded but could not start. Reload the page. If that does not help, " +
      `open it in a current Chrome, Edge or Firefox. (${error})`;
  } else {
    words.textContent =
      "MotorLink could not be loaded. Check your network connection and reload the page. If that " +
      `does not help, files are missing on the server. (${error})`;
  }
  document.body.replaceChildren(words);
}

// Compiles while the file is loading. Servers that do not send the MIME type of wasm work too.
async function compiled(fetched) {
  const response = await fetched;
  if (!response.ok) {
    throw new Error(`${wasmUrl.pathname}: ${response.status}`);
  }
  return response.headers.get("Content-Type") === "application/wasm"
    ? WebAssembly.compileStreaming(response)
    : WebAssembly.compile(await response.arrayBuffer());
}

// Waits for the first paint, which needs only index.html and its style. The wasm file is thirty times as large and
// is fetched after that, since both would share a slow connection. A hidden page is not painted, and some browsers
// do not report the paint: hence the other ways out.
function firstPaint() {
  return new Promise((painted) => {
    if (document.hidden) painted();
    document.addEventListener("visibilitychange", painted, { once: true });
    new PerformanceObserver(painted).observe({ type: "paint", buffered: true });
    setTimeout(painted, 500);
  });
}

// Fetches the style of what is shown later. It arrives before the wasm file, which is larger.
function fetchLaterStyle() {
  const sheet = document.createElement("link");
  sheet.rel = "stylesheet";
  sheet.href = new URL("./{{later_style}}", import.meta.url);
  document.head.append(sheet);
}

async function start() {
  // A dynamic import, so that its error can be shown.
  const imported = import("./{{glue}}");
  // An error before the await below is handled there, and only there.
  imported.catch(() => {});
  await firstPaint();
  fetchLaterStyle();
  const [glue, module] = await Promise.all([imported, compiled(fetch(wasmUrl))]);
  loaded = true;
  await glue.default({ module_or_path: module });
}

// The page is mounted part by part, each in its own task, where an error does not reach the `catch` below. The
// element `starting` of index.html is there until all parts are mounted.
for (const kind of ["error", "unhandledrejection"]) {
  addEventListener(kind, ({ error, reason }) => {
    if (document.getElementById("starting")) explain(error ?? reason);
  });
}

start().catch(explain);
