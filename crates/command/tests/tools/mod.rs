//! Tools of the tests: where one is missing, the test fails and says so in one line.

use std::{
    env, fs,
    path::PathBuf,
    process::Command,
    sync::{Mutex, PoisonError},
};

/// The packages, with their versions.
const REQUIREMENTS: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/tests/generated/requirements.txt"
);
/// The name of the environment, which changes with its packages.
const ENVIRONMENT: &str = "python-pyyaml-6.0.2-fastjsonschema-2.21.1-urdf-0.0.4";

/// Runs a program to its end, and returns what it prints; `missing` is what to say where there is none.
pub fn run(command: &mut Command, missing: &str) -> String {
    let output = command
        .output()
        .unwrap_or_else(|error| panic!("{missing} ({error})"));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}: {said}");
    String::from_utf8(output.stdout).unwrap()
}

/// A Python with the packages of `requirements.txt`, in an environment of its own.
///
/// It is kept where `cargo xtask` keeps its tools, beyond `cargo clean`, and made once.
pub fn python() -> PathBuf {
    static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());
    let _one = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    let tools = env::var_os("MOTORLINK_TOOLS").map(PathBuf::from);
    let cache = || Some(dirs::cache_dir()?.join("motorlink"));
    let tools = tools
        .or_else(cache)
        .expect("no cache directory: name one in MOTORLINK_TOOLS");
    let dir = tools.join("tools").join(ENVIRONMENT);
    let ready = dir.join("ready");
    let python = dir.join("bin/python");
    if ready.is_file() {
        return python;
    }
    let _ = fs::remove_dir_all(&dir);
    fs::create_dir_all(&dir).unwrap();
    let missing = "python3 with venv is missing: install it (Debian: apt-get install python3-venv)";
    run(
        Command::new("python3").args(["-m", "venv"]).arg(&dir),
        missing,
    );
    let pip = [
        "-m",
        "pip",
        "install",
        "--quiet",
        "--disable-pip-version-check",
        "-r",
    ];
    run(Command::new(&python).args(pip).arg(REQUIREMENTS), missing);
    fs::write(ready, "").unwrap();
    python
}
