// Starts the page. `cargo xtask build` fills in the names in double braces.

const wasmUrl = new URL("./{{wasm}}", import.meta.url);

// The policy in index.html lets markup and workers only through here: no element that could load or run
// something, and no script but our own.
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

// Module, glue and words are all there is before the Rust code runs, so what goes wrong up to then
// is told here or nowhere.
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

// Compiled while it comes. A server that does not know what wasm is still serves the page.
async function compiled(fetched) {
  const response = await fetched;
  if (!response.ok) {
    throw new Error(`${wasmUrl.pathname}: ${response.status}`);
  }
  return response.headers.get("Content-Type") === "application/wasm"
    ? WebAssembly.compileStreaming(response)
    : WebAssembly.compile(await response.arrayBuffer());
}

// What is seen first is in index.html. The program, thirty times as heavy, is fetched behind it: on a slow
// line they would hold each other up. The glue weighs little, and on a slow processor it is ready by then. A
// page that nobody sees is not painted, and a browser may not tell.
function firstPaint() {
  return new Promise((painted) => {
    if (document.hidden) painted();
    document.addEventListener("visibilitychange", painted, { once: true });
    new PerformanceObserver(painted).observe({ type: "paint", buffered: true });
    setTimeout(painted, 500);
  });
}

// The style of all that is mounted later: with the program, which takes longer.
function fetchLaterStyle() {
  const sheet = document.createElement("link");
  sheet.rel = "stylesheet";
  sheet.href = new URL("./{{later_style}}", import.meta.url);
  document.head.append(sheet);
}

async function start() {
  // An import in a try can be explained.
  const imported = import("./{{glue}}");
  // Where it fails before it is awaited, it is explained once: below.
  imported.catch(() => {});
  await firstPaint();
  fetchLaterStyle();
  const [glue, module] = await Promise.all([imported, compiled(fetch(wasmUrl))]);
  loaded = true;
  await glue.default({ module_or_path: module });
}

// The parts of the page come one by one, each in a turn of its own: one that fails fails there. Until all are
// there the frame of index.html is.
for (const kind of ["error", "unhandledrejection"]) {
  addEventListener(kind, ({ error, reason }) => {
    if (document.getElementById("starting")) explain(error ?? reason);
  });
}

start().catch(explain);
