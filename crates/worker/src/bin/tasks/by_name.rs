//! Starts a task by its name. The code of session files and that of runs are separate files, fetched on first use.
#![cfg_attr(
    feature = "parts",
    allow(unsafe_code, reason = "the call into a part, made by wasm_split")
)]

use std::sync::OnceLock;

use wasm_bindgen::prelude::{JsError, wasm_bindgen};

/// Handles an encoded input at this time, in microseconds, and returns the encoded output.
type RunProgram = fn(&[u8], f64) -> Vec<u8>;

static RUN_PROGRAM: OnceLock<RunProgram> = OnceLock::new();

/// Starts the task of this name: `recorder`, `sessions` or `runs`. Afterwards the recorder and the session worker receive
/// messages, and `run_program` can be called for runs.
///
/// # Errors
///
/// When the code of the task does not load, or no task has this name.
#[wasm_bindgen]
pub async fn start(name: String) -> Result<(), JsError> {
    match name.as_str() {
        "recorder" => motorlink_worker::start_recorder(),
        "sessions" => start_sessions().await?,
        "runs" => {
            let program = load_runs().await?;
            RUN_PROGRAM.get_or_init(|| program);
        }
        _ => return Err(JsError::new("no task has this name")),
    }
    Ok(())
}

/// Handles an encoded input of a run at this time, in microseconds, and returns the encoded output. The port worker calls
/// it after `start("runs")`; before that it returns nothing, which counts as a failure.
#[wasm_bindgen]
#[must_use]
pub fn run_program(input: &[u8], now_us: f64) -> Vec<u8> {
    let program = RUN_PROGRAM.get();
    program.map_or_else(Vec::new, |program| program(input, now_us))
}

/// Defines an async function that loads a part and then returns the value. The part has the code that only the value uses.
/// Without the feature `parts` all code is in one file.
macro_rules! in_part {
    ($part:ident: fn $name:ident() -> $loaded:ty { $value:expr }) => {
        #[cfg(feature = "parts")]
        #[wasm_split_helpers::wasm_split($part, fallible)]
        fn $name() -> Result<$loaded, wasm_split_helpers::SplitLoaderError> {
            Ok($value)
        }

        #[cfg(not(feature = "parts"))]
        async fn $name() -> Result<$loaded, std::convert::Infallible> {
            Ok($value)
        }
    };
}

in_part!(sessions: fn start_sessions() -> () { motorlink_worker::start_sessions() });
in_part!(runs: fn load_runs() -> RunProgram { motorlink_worker::run_program });
