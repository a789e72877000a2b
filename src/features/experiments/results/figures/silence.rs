//! What a motor did when frames ceased.

use motorlink_i18n::tr;
use motorlink_messages::experiments::study::SilenceFindings;

use super::{Figures, number};
use crate::{model::terms, ui::format::rpm};

pub(super) fn add(figures: &mut Figures, found: &SilenceFindings) {
    let unmeasurable = tr!("not measurable");
    let result = found.result.map_or(unmeasurable, terms::when_silent);
    figures.row(terms::when_frames_cease(), vec![Some(result.to_owned())]);
    let speeds = |(before, after): (Option<f64>, Option<f64>)| {
        let (before, after) = (number(before?, 0), number(after?, 0));
        Some(format!("{before} → {after} {}", rpm()))
    };
    figures.row(tr!("Speed with queries"), vec![speeds(found.asked_rpm)]);
    let unasked = vec![speeds(found.unasked_rpm)];
    figures.row(tr!("Speed without queries"), unasked);
    figures.says(match found.result {
        Some(_) => tr!(
            "What the motor did within 0.6 s. Its firmware may do something else later, so frames that cease are never a stop."
        ),
        None => tr!(
            "Replies are missing, the run was cut short, or the wheel did not turn freely at 30 rpm. Check the link and the wheel, then run it again."
        ),
    });
}

#[cfg(test)]
mod tests {
    use motorlink_messages::experiments::{analysis::WhenSilent, study::Findings};

    use super::*;
    use crate::ui::format::UNKNOWN;

    #[test]
    fn a_silence_says_its_result_or_that_it_was_not_measurable() {
        let mut found = SilenceFindings {
            result: Some(WhenSilent::Keeps),
            asked_rpm: (Some(30.0), Some(29.7)),
            unasked_rpm: (Some(30.0), None),
            curves: [Vec::new(), Vec::new()],
        };
        let values = |found: &SilenceFindings| {
            let figures = Figures::of(&Findings::Silence(found.clone()), "DDSM115");
            let rows = figures.rows.into_iter();
            rows.map(|row| row.values.concat()).collect::<Vec<_>>()
        };
        let expected = ["keeps its last command", "30 → 30 rpm", UNKNOWN];
        assert_eq!(values(&found), expected);
        found.result = None;
        assert_eq!(values(&found)[0], "not measurable");
    }
}
