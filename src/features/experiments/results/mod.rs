//! Charts and figures of runs, and the tab `Runs`.
