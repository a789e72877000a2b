// Starts a worker. `cargo xtask build` replaces the names in double braces.

// A module worker receives messages from its first `await` on, and a message without a listener is lost. These are
// the messages that arrive before the Rust code listens.
const early = [];
const keep = (event) => early.push(event);
self.addEventListener("message", keep);

async function start() {
  const program = fetch(new URL("./{{wasm}}", import.meta.url));
  // An error before the await below is reported there, and only there.
  program.catch(() => {});
  const glue = await import("./{{glue}}");
  await glue.default({ module_or_path: program });
  // The program `tasks` starts the task with the name of this worker. The others have no `start`.
  await glue.start?.(self.name);
  self.removeEventListener("message", keep);
  for (const { data, ports } of early) {
    self.dispatchEvent(new MessageEvent("message", { data, ports: [...ports] }));
  }
}

// A rejected promise stays inside the worker. A reported error reaches the `error` event of the page's Worker.
start().catch(reportError);
