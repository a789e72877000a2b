//! What happens to a process, act by act, while its driver waits.

use std::{sync::mpsc::sync_channel, time::Duration};

use motorlink_driver::Input;
use motorlink_protocol::Instant;

use super::{
    machine::{CHECKED_EVERY, Killed, Machine},
    scenario::Act,
};

/// Calls of a driver whose process is killed, until it must have ended.
const CALLS_AFTER_KILL: u32 = 5_000;

impl Machine {
    fn unplug(&mut self, time: Duration) {
        if let Some(number) = self.port.open.take() {
            let at = self.now + self.late();
            self.inputs.push((at, Input::PortGone(number)));
            // What a reader had read comes late, when another port may be open.
            let bytes = self.world.receive(self.now);
            let bytes = bytes.map_or_else(|| vec![0xC8; 10], |chunk| chunk.bytes.clone());
            let at = self.now + 5 * self.late();
            self.inputs.push((at, Input::Bytes(number, bytes)));
        }
        self.port.unplugged += 1;
        self.port.back_at = Some(self.now + time);
        self.rules.unplugged(self.now);
    }

    fn kill(&mut self) {
        self.rules.is_gone(self.now);
        self.killed = Some(Killed {
            now: self.now,
            calls: 0,
        });
        self.inputs.clear();
        self.inputs
            .extend(self.port.open.map(|open| (self.now, Input::PortGone(open))));
        self.inputs.push((self.now, Input::End));
    }

    /// Does an act. Returns the input that it gives to the driver.
    fn act(&mut self, act: Act, age: Duration) -> Option<Input> {
        self.done.push(act.into());
        let now = self.now;
        match act {
            Act::Command(command) => {
                if !command.is_too_old(age) {
                    self.rules.command(now, command, &self.world);
                }
                return Some(Input::Command(command));
            }
            Act::AskStatus => {
                let (answer, asked) = sync_channel(1);
                self.rules.asks_status(now, asked);
                return Some(Input::Status(answer));
            }
            Act::ProgramSilent(time) => {
                self.silent_until = now + time;
                self.rules.silent(now, time, &self.world);
            }
            Act::Unplug(time) if self.port.back_at.is_none() => self.unplug(time),
            Act::Unplug(_) => {}
            Act::PortRefuses(time) => {
                self.port.refuses_until = now + time;
                self.rules.disturbed();
            }
            Act::PortStalls(time) => {
                self.port.stalls_until = now + time;
                self.rules.disturbed();
            }
            Act::DiskFull(time) => self.disk_full_until = now + time,
            Act::Frozen(time) => {
                self.rules.freezes(now + time);
                self.advance(now + time);
            }
            Act::Fails => self.fails = true,
            Act::Kill => self.kill(),
            Act::End => {
                self.has_ended = true;
                self.rules.ends(now, &self.world);
                return Some(Input::End);
            }
        }
        None
    }

    /// The next act that is due, or the time at which the next one is.
    fn next_act(&mut self) -> Result<(Act, Duration), Instant> {
        let Some((pause, act)) = self.acts.front().copied() else {
            // A scenario that was shrunk may have no end.
            return if self.has_ended {
                Err(self.now + Duration::from_secs(1))
            } else {
                Ok((Act::End, Duration::ZERO))
            };
        };
        if act.is_of_program() {
            if self.has_ended {
                self.acts.pop_front();
                return self.next_act();
            }
            if !self.is_opened {
                // It waits for the port.
                self.act_at = self.now;
                return Err(self.now + CHECKED_EVERY);
            }
            self.act_at = self.act_at.max(self.silent_until);
        }
        let at = self.act_at + pause;
        if self.now < at {
            return Err(at);
        }
        self.acts.pop_front();
        self.act_at = at;
        Ok((act, self.now.since(at)))
    }

    pub(super) fn wait(&mut self, until: Instant) -> Option<(Input, Duration)> {
        if self.violation.is_some() && self.killed.is_none() {
            // The result is known.
            self.kill();
        }
        if let Some(killed) = &mut self.killed {
            killed.calls += 1;
            assert!(
                killed.calls < CALLS_AFTER_KILL,
                "a driver without a port does not end"
            );
            let input = (!self.inputs.is_empty()).then(|| self.inputs.remove(0).1);
            if input.is_none() {
                killed.now = until.max(killed.now + Duration::from_millis(1));
            }
            return input.map(|input| (input, Duration::ZERO));
        }
        loop {
            let act_at = match self.next_act() {
                Ok((act, age)) => {
                    let input = self.act(act, age);
                    if self.killed.is_some() {
                        return self.wait(until);
                    }
                    if let Some(input) = input {
                        return Some((input, age));
                    }
                    continue;
                }
                Err(at) => at,
            };
            let due = self.inputs.iter().position(|(at, _)| *at <= self.now);
            if let Some(place) = due {
                let (at, input) = self.inputs.remove(place);
                return Some((input, self.now.since(at)));
            }
            if let Some(input) = self.bytes() {
                return Some((input, Duration::ZERO));
            }
            if self.now >= until {
                return None;
            }
            let inputs = self.inputs.iter().map(|(at, _)| *at);
            let others = [act_at, self.port.stalls_until];
            let events = inputs.chain(others).chain(self.world.next_event());
            let later = events.filter(|at| *at > self.now);
            self.advance(later.fold(until, Instant::min));
            if self.violation.is_some() {
                return self.wait(until);
            }
        }
    }

    /// Bytes that the port gives. They are lost while it is not open.
    fn bytes(&mut self) -> Option<Input> {
        if self.port.open.is_some() && self.port.is_stalled(self.now) {
            return None;
        }
        let chunk = self.world.receive(self.now)?;
        let bytes = chunk.bytes.clone();
        let number = self.port.open?;
        Some(Input::Bytes(number, bytes))
    }
}
