//! Measures the load of the page's main thread with the browser's own measurements.

use std::time::Duration;

use anyhow::{Context, Result};
use serde_json::Value;

use crate::page::Page;

/// The load of the main thread in a period.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Work {
    /// Tasks of more than 50 ms, oldest first.
    pub long_tasks: Vec<Duration>,
    /// The page's own measurements (`performance.measure`), by name, oldest first.
    pub measures: Vec<(String, Duration)>,
}

impl Work {
    /// The longest task; zero if none took more than 50 ms.
    #[must_use]
    pub fn longest_task(&self) -> Duration {
        self.long_tasks.iter().max().copied().unwrap_or_default()
    }

    /// The durations of this measurement, shortest first.
    #[must_use]
    pub fn durations_of(&self, name: &str) -> Vec<Duration> {
        let of_name = self.measures.iter().filter(|(of, _)| of == name);
        let mut durations: Vec<Duration> = of_name.map(|(_, duration)| *duration).collect();
        durations.sort_unstable();
        durations
    }
}

impl Page {
    /// The load of the main thread since the last call, or since the page was loaded.
    ///
    /// # Errors
    ///
    /// When Chromium does not answer.
    pub fn work(&self) -> Result<Work> {
        // The browser reports a task after it has ended and the next one has begun.
        let taken = self.evaluate(
            "new Promise((resolve) => setTimeout(() => setTimeout(() => resolve(benchWork.take()))))",
        )?;
        let list = |name: &str| {
            let list = taken.get(name).and_then(Value::as_array);
            list.with_context(|| format!("the page noted no {name}"))
        };
        let long_tasks = list("tasks")?.iter().map(duration).collect::<Result<_>>()?;
        let measures = list("measures")?
            .iter()
            .map(|measure| {
                let name = measure.get(0).and_then(Value::as_str);
                let took = duration(measure.get(1).unwrap_or(&Value::Null))?;
                Ok((name.context("a measure without a name")?.to_owned(), took))
            })
            .collect::<Result<_>>()?;
        Ok(Work {
            long_tasks,
            measures,
        })
    }
}

fn duration(ms: &Value) -> Result<Duration> {
    let ms = ms.as_f64().context("a time that is no number")?;
    Duration::try_from_secs_f64(ms / 1e3).context("a time that is none")
}
