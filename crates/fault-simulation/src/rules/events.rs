//! What an event of the bus says.

use motorlink_bus::{Event, LineEventKind, StopReason, StopReport, WithdrawReason};
use motorlink_protocol::{Instant, MotorId};
use motorlink_simulator::World;

use crate::rule::{Outcome, Rule, broken};

use super::{Rules, truth};

impl Rules {
    /// The bus reports an event.
    pub(crate) fn on_event(&mut self, now: Instant, event: &Event, world: &World) -> Outcome {
        self.operator.on_event(now, event);
        self.starts.on_event(now, event);
        self.wire.on_event(now, event)?;
        self.truth.on_event(now, event, world)?;
        match event {
            Event::StopBegan(reason) => {
                self.stop_began = Some(now);
                self.liveness.stop_begins(now, &[]);
                if *reason == StopReason::PageSilent {
                    self.judge(Rule::DeadPageStops);
                    self.stop_begins(now, |_| true);
                    self.moves_no_more(now, world, |_| true);
                }
            }
            Event::StopEnded(report) => {
                self.stop_began = None;
                self.judge(Rule::StopEnds);
                for rule in self.liveness.stop_ended(now, report)? {
                    self.judge(rule);
                }
                self.confirmed_stand(now, report, world)?;
                self.operator.stopped(report);
                // A stop that joined one whose last brake was on its way.
                let confirmed = report.motors.iter().filter(|outcome| outcome.confirmed);
                for outcome in confirmed {
                    self.stops.remove(&outcome.id);
                }
                return self.names_all(now, report);
            }
            Event::Withdrawn { id, reason } => {
                match reason {
                    WithdrawReason::Silent => self.judge(Rule::SilentIsWithdrawn),
                    WithdrawReason::Limit(_) | WithdrawReason::TemperatureUnknown => {
                        self.judge(Rule::LimitsHold);
                    }
                    WithdrawReason::Fault(_)
                    | WithdrawReason::AngleMisfits
                    | WithdrawReason::NotEnabled
                    | WithdrawReason::OtherLoop { .. } => {}
                }
                self.stop_begins(now, |other| other == id);
                self.moves_no_more(now, world, |other| other == id);
            }
            Event::Telemetry(sample) => {
                self.judge(Rule::TelemetryIsTrue);
                self.invented.reported(now, sample)?;
                self.unasked.reported(*sample);
                self.judge(Rule::NoInventedValue);
            }
            Event::Line(traffic) => self.judge(match traffic.kind {
                LineEventKind::Received { .. } => Rule::GoodRepliesAreHeard,
                _ => Rule::LogIsComplete,
            }),
            _ => {}
        }
        Ok(())
    }

    /// A motor that reports no speed is confirmed by its angle.
    pub(super) fn confirmed_stand(
        &mut self,
        now: Instant,
        report: &StopReport,
        world: &World,
    ) -> Outcome {
        for outcome in &report.motors {
            if self.speed_stuck.contains(&outcome.id) {
                self.judge(Rule::StandstillIsTrue);
                truth::confirmed(Rule::StandstillIsTrue, now, *outcome, world)?;
            } else {
                truth::confirmed(Rule::StopEnds, now, *outcome, world)?;
            }
        }
        Ok(())
    }

    pub(super) fn names_all(&mut self, now: Instant, report: &StopReport) -> Outcome {
        let named = |id: &MotorId| report.motors.iter().any(|outcome| outcome.id == *id);
        let left_out = self.reported.drain(..).find(|id| !named(id));
        match left_out {
            Some(id) => broken(Rule::StopEnds, now, format!("{id} is not in the report")),
            None => Ok(()),
        }
    }
}
