//! Finds out which model the motors on a port are, by opening it for one model after the other.

use std::time::Duration;

use motorlink_protocol::family::Model;

/// How long a motor may take to send a frame of its model: an ID query of 60 ms and two queries at 10 Hz.
pub(crate) const DETECTION_MAX: Duration = Duration::from_millis(200);

/// The models to open a port for, one after the other: the likely one first, then what replies show, then the other
/// baud rate.
#[derive(Clone, Debug)]
pub(crate) struct ModelSearch {
    tried: Vec<Model>,
    /// The first that replies have shown.
    shown: Option<Model>,
    next: Option<Model>,
}

impl ModelSearch {
    /// A search that begins with this model.
    pub(crate) const fn from(first: Model) -> Self {
        Self {
            tried: Vec::new(),
            shown: None,
            next: Some(first),
        }
    }

    /// A search without a model.
    pub(crate) const fn of_none() -> Self {
        Self {
            tried: Vec::new(),
            shown: None,
            next: None,
        }
    }

    /// The model to open the port for; `None` if no motor has answered as any.
    pub(crate) fn next_model(&mut self) -> Option<Model> {
        let model = self.next.take()?;
        self.tried.push(model);
        Some(model)
    }

    /// The trial of that model has ended without a motor of it. `other` is the model that replies have shown.
    pub(crate) fn not_found(&mut self, other: Option<Model>) {
        let of_either_baud = [Model::Ddsm115, Model::Ddsm400];
        let untried = |model: &Model| {
            let same_baud = |tried: &Model| tried.spec().baud == model.spec().baud;
            !self.tried.iter().any(same_baud)
        };
        // Noise may show another model too: one that was shown is tried twice before the search ends.
        self.shown = self.shown.or(other);
        let tries = |model: &Model| self.tried.iter().filter(|tried| *tried == model).count();
        // At a baud that was tried, only a model that a reply has shown: the stop of another one could turn the wheel.
        self.next = other
            .or(self.shown)
            .filter(|model| tries(model) < 2)
            .or_else(|| of_either_baud.into_iter().find(untried));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tried(first: Model, shown: &[(Model, Model)]) -> Vec<Model> {
        let mut search = ModelSearch::from(first);
        let mut tried = Vec::new();
        while let Some(model) = search.next_model() {
            tried.push(model);
            let other = shown.iter().find(|(at, _)| *at == model);
            search.not_found(other.map(|(_, other)| *other));
        }
        tried
    }

    #[test]
    fn a_silent_port_is_tried_once_at_each_baud_rate() {
        assert_eq!(tried(Model::Ddsm210, &[]), [Model::Ddsm210, Model::Ddsm400]);
        assert_eq!(tried(Model::Ddsm400, &[]), [Model::Ddsm400, Model::Ddsm115]);
    }

    #[test]
    fn a_model_that_replies_show_is_tried_next_and_at_most_twice() {
        let both_show_the_other = [
            (Model::Ddsm115, Model::Ddsm210),
            (Model::Ddsm210, Model::Ddsm115),
        ];
        assert_eq!(
            tried(Model::Ddsm115, &both_show_the_other),
            [
                Model::Ddsm115,
                Model::Ddsm210,
                Model::Ddsm115,
                Model::Ddsm210,
                Model::Ddsm400
            ]
        );
    }
    #[test]
    fn noise_on_the_right_model_does_not_rule_it_out() {
        let mut search = ModelSearch::from(Model::Ddsm115);
        let shown = [Some(Model::Ddsm210), Some(Model::Ddsm400), None];
        let tried = shown.map(|other| {
            let model = search.next_model();
            search.not_found(other);
            model
        });
        let in_turn = [Model::Ddsm115, Model::Ddsm210, Model::Ddsm400];
        assert_eq!(tried, in_turn.map(Some));
        assert_eq!(search.next_model(), Some(Model::Ddsm210));
    }
}
