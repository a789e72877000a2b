// Starts a worker. `cargo xtask build` fills in the names in double braces.

// A module worker gets its messages from its first await on, and one that nobody listens to is
// lost. Keep what the page says before the Rust code listens.
const early = [];
const keep = (event) => early.push(event);
self.addEventListener("message", keep);

async function start() {
  const program = fetch(new URL("./{{wasm}}", import.meta.url));
  // Where it fails before it is awaited, it is reported once: below.
  program.catch(() => {});
  const glue = await import("./{{glue}}");
  await glue.default({ module_or_path: program });
  self.removeEventListener("message", keep);
  for (const { data, ports } of early) {
    self.dispatchEvent(new MessageEvent("message", { data, ports: [...ports] }));
  }
}

// A rejected promise would stay inside the worker; a reported error reaches the page's `error`
// event on its Worker.
start().catch((error) => self.reportError(error));
