// Starts the worker. `cargo xtask build` fills in the names in double braces.

const wasmUrl = new URL("./{{wasm}}", import.meta.url);

// A module worker gets its messages from its first await on, and one that nobody listens to is
// lost. Keep what the page says before the Rust code listens.
const early = [];
const keep = (event) => early.push(event);
self.addEventListener("message", keep);

async function start() {
  const [glue, response] = await Promise.all([import("./{{glue}}"), fetch(wasmUrl)]);
  if (!response.ok) {
    throw new Error(`${wasmUrl.pathname}: ${response.status}`);
  }
  await glue.default({ module_or_path: response });
  self.removeEventListener("message", keep);
  for (const { data, ports } of early) {
    self.dispatchEvent(new MessageEvent("message", { data, ports: [...ports] }));
  }
}

// A rejected promise would stay inside the worker; a reported error reaches the page's `error`
// event on its Worker.
start().catch((error) => self.reportError(error));
