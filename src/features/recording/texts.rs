//! The texts of the recording.

use motorlink_i18n::tr;
use motorlink_messages::recorder::RecordingStatus;

use crate::ui::format::{grouped, stopwatch};

/// What an export of the telemetry contains now, and how much.
pub(crate) fn of_recording(status: &RecordingStatus) -> (&'static str, String) {
    if !status.recording && status.recorded == 0 {
        return (tr!("Last 10 min: "), samples(status.rolling));
    }
    let what = match status {
        RecordingStatus {
            recording: true, ..
        } => tr!("Recording: "),
        RecordingStatus { exported: true, .. } => tr!("Recorded and exported: "),
        RecordingStatus { full: true, .. } => tr!("Recording is full: "),
        _ => tr!("Recorded: "),
    };
    let samples = samples(status.recorded);
    let time = stopwatch(status.recorded_ms);
    (what, format!("{time}, {samples}"))
}

/// `1 sample`, `9 000 samples`
fn samples(number: u64) -> String {
    match number {
        1 => tr!("1 sample").to_owned(),
        count => tr!("{count} samples", count = grouped(count)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(text: &str) -> String {
        text.replace('\u{202F}', " ")
    }

    #[test]
    fn the_recording_says_what_a_file_of_it_would_hold() {
        let mut status = RecordingStatus {
            rolling: 6_012,
            ..RecordingStatus::default()
        };
        let mut says = |change: fn(&mut RecordingStatus)| {
            change(&mut status);
            let (what, much) = of_recording(&status);
            plain(&format!("{what}{much}"))
        };
        assert_eq!(says(|_| {}), "Last 10 min: 6 012 samples");
        let recording = says(|status| {
            status.recording = true;
            status.recorded = 6_650;
            status.recorded_ms = 133_000;
        });
        assert_eq!(recording, "Recording: 00:02:13, 6 650 samples");
        assert_eq!(
            says(|status| status.recording = false),
            "Recorded: 00:02:13, 6 650 samples"
        );
        assert!(says(|status| status.full = true).starts_with("Recording is full: 00"));
        assert!(says(|status| status.exported = true).starts_with("Recorded and exported"));
    }
}
