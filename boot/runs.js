// Loads the code that runs experiments into the port worker: see runs.rs of the worker.
self.loadRuns = async () => {
  const glue = await import("./{{runs_glue}}");
  await glue.default({ module_or_path: fetch(new URL("./{{runs_wasm}}", import.meta.url)) });
  return glue.run_program;
};

