//! Periodic checks of every motor: setpoints, mode switches, stops, silence.

use motorlink_protocol::{
    CurrentTarget, Faults, Instant, Mode, OpenLoopTarget, Rpm, Setpoint, SpeedTarget,
};

use crate::{
    bus::Bus,
    event::{Event, StopReason, WithdrawReason},
    mode_switch::{Progress, Switch},
    motor::{Control, Driven, Motor},
    motor_status::Answer,
    safety::check_driven,
    timing::{DRIVEN_SILENCE_MAX, DRIVEN_UNANSWERED_MAX},
};

impl Bus {
    /// Withdraws setpoints that are no longer safe, ends mode switches and stops, reports silent
    /// motors.
    pub(crate) fn supervise_motors(&mut self, now: Instant) {
        let mut to_stop = Vec::new();
        // The bus enables a motor only after the trial of the port, and while no other host drives: in the velocity
        // loop the motor reads that host's setpoints as speeds. Start does not wait for this.
        let may_enable = self.enables_from.is_some_and(|from| now >= from)
            && self.stop.is_none()
            && self.check_not_halted().is_ok()
            && self.check_no_job().is_ok()
            && self.check_no_raw_hazard().is_ok();
        for motor in &mut self.motors {
            if motor.falls_silent(now) {
                motor.answer = motor.silence_kind();
                motor.rest.wait_for_reply();
                self.events.push_back(Event::MotorSilent {
                    id: motor.id,
                    garbled: motor.answer == Answer::Corrupted,
                });
            }
            if may_enable && matches!(motor.control, Control::Idle) && motor.needs_enable(now) {
                // This starts no motion: the motor gets no drive frame.
                motor.separate.enabling.tried(now);
                motor.control = Control::Switching(Switch::without_command(now, Mode::Velocity));
            }
            if let Control::Switching(switch) = motor.control {
                match switch.progress(now) {
                    Progress::Underway => {}
                    // A reply before the last frame has reported the loop: until the reply to the query behind it, no
                    // command of this loop would be accepted.
                    Progress::Confirmed
                        if motor.loop_is_unconfirmed() && now < switch.fails_at() => {}
                    Progress::Confirmed => {
                        motor.control = after_switch(now, &switch, motor.fresh_speed(now));
                        if matches!(motor.control, Control::Driven(_)) {
                            motor.rest.doubt();
                        }
                        // The page opens the tab of this loop, so only a switch that the operator requested is
                        // reported.
                        if switch.by_command {
                            self.events.push_back(Event::ModeSwitched {
                                id: motor.id,
                                mode: switch.to,
                            });
                        }
                    }
                    Progress::Failed => {
                        self.events.push_back(Event::ModeSwitchFailed {
                            id: motor.id,
                            asked: switch.to,
                            reported: motor.fresh_mode(now),
                        });
                        if switch.was_driven {
                            to_stop.push(motor.id);
                        } else {
                            motor.control = Control::Idle;
                        }
                    }
                }
            }
            // After the switch: a setpoint that it starts passes the same checks before its first
            // frame.
            if let Control::Driven(driven) = motor.control {
                let quiet = motor.silence_while_driven(now, &driven);
                let faults = motor.fresh_faults(now).unwrap_or(Faults::NONE);
                let withdrawn = check_driven(
                    Some(driven.goal.mode()),
                    motor.last_mode(),
                    faults,
                    motor
                        .exceeded(now, self.settings.limits, driven.since)
                        .or(self.settings.limits.exceeded_by(driven.goal)),
                    quiet,
                    motor.unanswered_in_a_row,
                );
                let withdrawn = withdrawn
                    .or((!motor.obeys()).then_some(WithdrawReason::NotEnabled))
                    .or(motor.temperature_unknown(now, driven.since));
                if let Some(reason) = withdrawn {
                    self.events.push_back(Event::Withdrawn {
                        id: motor.id,
                        reason,
                    });
                    to_stop.push(motor.id);
                }
            }
        }
        if !to_stop.is_empty() {
            self.begin_stop(now, StopReason::OneMotor, &|motor| {
                to_stop.contains(&motor.id)
            });
        }
        self.supervise_raw(now);
        self.end_stop(now);
    }

    /// When this motor must be checked next.
    pub(crate) fn deadline(motor: &Motor, now: Instant) -> Option<Instant> {
        // The end of a reply window wakes the bus if it comes later.
        let silent =
            (!motor.answer.is_silent() && now < motor.silent_at()).then(|| motor.silent_at());
        let control = match &motor.control {
            Control::Idle => None,
            // With fewer unanswered requests, the end of a reply window comes first and wakes the
            // bus.
            Control::Driven(driven) => {
                (motor.unanswered_in_a_row >= DRIVEN_UNANSWERED_MAX).then(|| {
                    motor.silent_since().max(driven.silent_from())
                        + motor.stalled
                        + DRIVEN_SILENCE_MAX
                })
            }
            Control::Switching(switch) => switch.next_frame().is_none().then(|| switch.fails_at()),
            // After its window it only waits for the other motors of the stop.
            Control::Stopping(stop) => (!stop.is_over(now)).then(|| stop.window_ends()),
        };
        silent.into_iter().chain(control).min()
    }
}

/// The control state after a switch. A driven motor stays driven at zero if both loops know a
/// neutral zero; else it is idle until the operator asks.
pub(crate) fn after_switch(now: Instant, switch: &Switch, speed: Option<Rpm>) -> Control {
    let zero = match switch.to {
        Mode::Velocity => Some(Setpoint::velocity(SpeedTarget::ZERO)),
        Mode::Current => Some(Setpoint::Current(CurrentTarget::ZERO)),
        Mode::OpenLoop => Some(Setpoint::OpenLoop(OpenLoopTarget::ZERO)),
        Mode::Position => None,
    };
    let goal = switch
        .queued_setpoint
        .or(zero.filter(|_| switch.was_driven));
    goal.map_or(Control::Idle, |goal| {
        Control::Driven(Driven {
            // Silence during the switch counts.
            since: switch.began,
            ..Driven::begin(now, goal, speed)
        })
    })
}
