// Loads the code that runs experiments into the port worker: see crates/worker/src/runs/loading.rs.
self.loadRuns = async () => {
  const glue = await import("./{{tasks_glue}}");
  await glue.default({ module_or_path: new URL("./{{tasks_wasm}}", import.meta.url) });
  await glue.start("runs");
  return glue.run_program;
};
