//! The models that a port is opened for, one after the other, and what is done with motors that were left driven on it.

use std::time::Duration;

use motorlink_bus::{Bus, DetectedModel};
use motorlink_protocol::{Instant, family::Model};

use crate::model_search::{DETECTION_MAX, ModelSearch};

/// How long a motor may take to answer before another model or port is tried: an ID query of 60 ms and three
/// queries at 10 Hz.
pub(crate) const ANSWER_MAX: Duration = Duration::from_millis(400);

/// How a trial treats motors that an earlier bus left driven.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LeftMotors {
    /// Those of a like model are stopped first.
    Stop,
    /// It leaves them alone.
    Leave,
}

/// What a trial waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Awaited {
    /// A reply of any motor.
    Reply,
    /// Replies of the model.
    Model,
    /// Nothing: this is the last trial.
    Nothing,
}

impl Awaited {
    /// How long that may take.
    pub(crate) const fn limit(self) -> Duration {
        match self {
            Self::Reply => ANSWER_MAX,
            Self::Model => DETECTION_MAX,
            Self::Nothing => Duration::ZERO,
        }
    }

    /// The model that the replies so far show; `None` while they are not enough. For [`Awaited::Reply`] one reply is
    /// enough, and counts as the model of the line.
    pub(crate) fn found(self, bus: &Bus, now: Instant) -> Option<DetectedModel> {
        match self {
            Self::Reply => {
                let mut motors = bus.motors(now);
                let has_replied = motors.any(|motor| motor.last.is_some());
                has_replied.then_some(DetectedModel::Own)
            }
            Self::Model => bus.detected_model(now),
            Self::Nothing => None,
        }
    }
}

/// How the port is opened once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PortTrial {
    /// For this model.
    pub(crate) model: Model,
    /// How it treats motors that were left driven.
    pub(crate) left: LeftMotors,
    /// What it waits for. [`OpeningOrder::tried`] says whether the port then stays open.
    pub(crate) awaits: Awaited,
}

/// The trials of one port, until one of them stays open.
#[derive(Clone, Debug)]
pub(crate) struct OpeningOrder {
    /// The model of the motors that were left driven.
    left: Option<Model>,
    search: ModelSearch,
    trial: PortTrial,
    /// The model of the last trial.
    last: Model,
}

impl OpeningOrder {
    /// The first model is `likely` if its frames also stop the motors that were left driven, else theirs. `chosen` is the model that a person has chosen; `None`:
    /// the model is detected. If no motor answers, the port stays open for the chosen model, or else for `likely`.
    pub(crate) fn new(left: Option<Model>, chosen: Option<Model>, likely: Model) -> Self {
        // Frames of a like model stop them too.
        let first = left.filter(|left| !left.is_like(likely)).unwrap_or(likely);
        let mut order = Self {
            left,
            search: match chosen {
                Some(_) => ModelSearch::of_none(),
                None => ModelSearch::from(first),
            },
            trial: PortTrial {
                model: first,
                left: LeftMotors::Stop,
                awaits: Awaited::Reply,
            },
            last: chosen.unwrap_or(likely),
        };
        if left.is_none() {
            order.next();
        }
        order
    }

    /// How to open the port now.
    pub(crate) const fn trial(&self) -> PortTrial {
        self.trial
    }

    /// Records the result of the trial: the model that it has shown, or `None` if it has shown none within
    /// [`Awaited::limit`]. Returns whether the port stays open.
    pub(crate) fn tried(&mut self, found: Option<DetectedModel>) -> bool {
        let PortTrial { model, awaits, .. } = self.trial;
        match (awaits, found) {
            (Awaited::Nothing, _) | (Awaited::Reply, Some(_)) => return true,
            (Awaited::Model, Some(DetectedModel::Own)) => {
                if self.left.is_none_or(|left| !left.is_like(model)) {
                    return true;
                }
                // The left-driven motors did not answer before, and may now.
                self.stay_with(model);
                return false;
            }
            (Awaited::Model, Some(DetectedModel::Other(other))) => {
                self.search.not_found(Some(other));
            }
            (Awaited::Model, None) => self.search.not_found(None),
            (Awaited::Reply, None) => {}
        }
        self.next();
        false
    }

    fn next(&mut self) {
        match self.search.next_model() {
            Some(model) => {
                self.trial = PortTrial {
                    model,
                    left: LeftMotors::Leave,
                    awaits: Awaited::Model,
                }
            }
            None => self.stay_with(self.last),
        }
    }

    /// Tries no other model. Left-driven motors are stopped at once, and again when they answer.
    const fn stay_with(&mut self, model: Model) {
        self.trial = PortTrial {
            model,
            left: LeftMotors::Stop,
            awaits: Awaited::Nothing,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: Option<DetectedModel> = None;

    /// The trials until one stays open, if they show these models.
    fn trials(
        mut order: OpeningOrder,
        found: &[Option<DetectedModel>],
    ) -> Vec<(Model, LeftMotors)> {
        let mut trials = Vec::new();
        for found in found.iter().copied().chain([NONE; 8]) {
            let trial = order.trial();
            trials.push((trial.model, trial.left));
            if order.tried(found) {
                return trials;
            }
        }
        panic!("no end: {trials:?}");
    }

    #[test]
    fn a_port_on_which_nothing_was_left_is_opened_until_its_model_answers() {
        use LeftMotors::{Leave, Stop};
        let order = OpeningOrder::new(None, None, Model::Ddsm115);
        let own = Some(DetectedModel::Own);
        assert_eq!(trials(order.clone(), &[own]), [(Model::Ddsm115, Leave)]);
        let other = Some(DetectedModel::Other(Model::Ddsm210));
        let found = [(Model::Ddsm115, Leave), (Model::Ddsm210, Leave)];
        assert_eq!(trials(order.clone(), &[other, own]), found);
        let silent = [
            (Model::Ddsm115, Leave),
            (Model::Ddsm400, Leave),
            (Model::Ddsm115, Stop),
        ];
        assert_eq!(trials(order, &[]), silent);
    }

    #[test]
    fn what_was_left_is_stopped_first_and_again_if_its_model_answers_later() {
        use LeftMotors::{Leave, Stop};
        let left = Model::Ddsm210;
        let order = OpeningOrder::new(Some(left), None, left);
        let own = Some(DetectedModel::Own);
        assert_eq!(trials(order.clone(), &[own]), [(left, Stop)]);
        let later = [(left, Stop), (left, Leave), (left, Stop)];
        assert_eq!(trials(order.clone(), &[NONE, own]), later);
        let other = [(left, Stop), (left, Leave), (Model::Ddsm400, Leave)];
        assert_eq!(trials(order.clone(), &[NONE, NONE, own]), other);
        let silent = [other.as_slice(), &[(left, Stop)]].concat();
        assert_eq!(trials(order, &[]), silent);

        // The likely model is another one than that of the motors.
        let order = OpeningOrder::new(Some(Model::Ddsm400), None, Model::Ddsm115);
        let silent = [
            (Model::Ddsm400, Stop),
            (Model::Ddsm400, Leave),
            (Model::Ddsm115, Leave),
            (Model::Ddsm115, Stop),
        ];
        assert_eq!(trials(order, &[]), silent);
    }

    #[test]
    fn a_like_model_that_answers_later_is_that_of_the_left_driven_motors() {
        use LeftMotors::{Leave, Stop};
        let [left, like] = [Model::Ddsm115, Model::Ddsm315];
        assert!(left.is_like(like));
        let order = OpeningOrder::new(Some(left), None, left);
        let found = [
            NONE,
            Some(DetectedModel::Other(like)),
            Some(DetectedModel::Own),
        ];
        let expected = [(left, Stop), (left, Leave), (like, Leave), (like, Stop)];
        assert_eq!(trials(order, &found), expected);
    }

    #[test]
    fn a_model_that_a_person_has_chosen_is_not_searched_for() {
        use LeftMotors::Stop;
        let [left, chosen] = [Model::Ddsm400, Model::Ddsm115];
        let order = OpeningOrder::new(None, Some(chosen), left);
        assert_eq!(trials(order, &[]), [(chosen, Stop)]);
        let order = OpeningOrder::new(Some(left), Some(chosen), left);
        assert_eq!(trials(order, &[]), [(left, Stop), (chosen, Stop)]);
    }
}
