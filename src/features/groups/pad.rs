//! Hold to run: a two-sided vehicle is driven only while a stick is held.
//!
//! The stick is a pointer on the pad, the arrow keys or a gamepad; the first one pressed has control. Only a
//! press starts a hold. After a hold has ended for any reason, the same stick has to be released and pressed
//! again: a finger that still moves starts nothing.

use crate::{features::groups::wheels::Wheels, ui::mathematics::limited};

/// The dead zone, as a part of the full travel: no stick returns exactly to the middle.
const DEAD: f64 = 0.08;

/// The number of gamepads that browsers support.
pub(crate) const GAMEPADS_MAX: u8 = 4;

/// The arrow keys, in the order of [`DrivePad::arrows`].
const ARROWS: [&str; 4] = ["ArrowUp", "ArrowDown", "ArrowLeft", "ArrowRight"];

/// The position of the stick, -1 to 1 on each axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Stick {
    /// + is forward.
    pub(crate) forward: f64,
    /// + is to the right.
    pub(crate) turn: f64,
}

impl Stick {
    pub(crate) fn new(turn: f64, forward: f64) -> Self {
        let part = |way: f64| {
            if way.abs() > DEAD {
                limited(way, -1.0, 1.0)
            } else {
                0.0
            }
        };
        Self {
            forward: part(forward),
            turn: part(turn),
        }
    }

    /// The speeds of both sides. If forward and turn together exceed the limit, both sides are scaled, so that the
    /// vehicle keeps its curve.
    #[allow(
        clippy::cast_possible_truncation,
        reason = "a part of the limit, which is a whole number"
    )]
    pub(crate) fn wheels(self, limit_rpm: i32) -> Wheels {
        let (left, right) = (self.forward + self.turn, self.forward - self.turn);
        let most = left.abs().max(right.abs()).max(1.0);
        let rpm = |part: f64| (part / most * f64::from(limit_rpm)).round() as i32;
        Wheels {
            left: rpm(left),
            right: rpm(right),
        }
    }
}

/// The source of the stick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum By {
    /// A pointer with this number.
    Pointer(i32),
    /// The arrow keys, all of them as one.
    Keys,
    /// The gamepad at this place, 0 to [`GAMEPADS_MAX`] - 1.
    Gamepad(u8),
}

/// A command for the bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Order {
    /// Drive the group.
    Start(Wheels),
    /// Adjust the group, if it is driven.
    Adjust(Wheels),
    /// Stop the group.
    Stop,
}

/// The maximal speed in rpm if driving may begin now. Called only at a press.
pub(crate) type Allowed<'a> = &'a dyn Fn() -> Option<i32>;

/// The pad.
#[derive(Debug, Default)]
pub(crate) struct DrivePad {
    held: Option<Held>,
    /// Keys and gamepads that have not been released since they were pressed. Pointers are not among them: their
    /// press is an event, not a state.
    down: Vec<By>,
    arrows: [bool; 4],
    /// Gamepads whose button was up at a poll, one bit each: only these can be pressed.
    rested: u8,
}

#[derive(Clone, Copy, Debug)]
struct Held {
    by: By,
    stick: Stick,
    sent: Wheels,
    limit_rpm: i32,
}

impl DrivePad {
    pub(crate) const fn is_held(&self) -> bool {
        self.held.is_some()
    }

    /// The stick while it drives, and the speeds that were sent.
    pub(crate) fn driving(&self) -> Option<(Stick, Wheels)> {
        self.held.map(|held| (held.stick, held.sent))
    }

    /// The stick is pressed. It starts a hold if no other stick holds the pad and driving is allowed.
    ///
    /// If the same pointer already holds the pad, its release was missed.
    pub(crate) fn press(&mut self, by: By, stick: Stick, allowed: Allowed) -> Option<Order> {
        if matches!(by, By::Pointer(_)) && self.held.is_some_and(|held| held.by == by) {
            return self.end();
        }
        if self.down.contains(&by) {
            self.steer(by, stick);
            return None;
        }
        if !matches!(by, By::Pointer(_)) {
            self.down.push(by);
        }
        if self.is_held() {
            return None;
        }
        let limit_rpm = allowed()?.abs();
        let sent = stick.wheels(limit_rpm);
        self.held = Some(Held {
            by,
            stick,
            sent,
            limit_rpm,
        });
        Some(Order::Start(sent))
    }

    /// The stick moves; [`DrivePad::frame`] returns the command.
    pub(crate) fn steer(&mut self, by: By, moved: Stick) {
        if let Some(held) = self.held.as_mut().filter(|held| held.by == by) {
            held.stick = moved;
        }
    }

    /// The stick is released.
    pub(crate) fn release(&mut self, by: By) -> Option<Order> {
        self.down.retain(|down| *down != by);
        let held = self.held.filter(|held| held.by == by);
        held.and_then(|_| self.end())
    }

    /// An arrow key is pressed or released; repeats do not count.
    ///
    /// If a key is pressed twice, its release was missed, and others may have been missed too: that is a release,
    /// not a press.
    pub(crate) fn arrow(&mut self, key: &str, is_down: bool, allowed: Allowed) -> Option<Order> {
        let place = ARROWS.iter().position(|arrow| *arrow == key)?;
        let was_down = std::mem::replace(self.arrows.get_mut(place)?, is_down);
        if is_down && was_down {
            return self.leave();
        }
        if !self.arrows.contains(&true) {
            return self.release(By::Keys);
        }
        let [up, down, left, right] = self.arrows.map(|is_down| f64::from(u8::from(is_down)));
        self.press(By::Keys, Stick::new(right - left, up - down), allowed)
    }

    /// The state of a gamepad: whether its button is down, and its stick; `None` without a gamepad.
    ///
    /// A button that is down at the first poll was not pressed here, so it starts nothing.
    pub(crate) fn gamepad(
        &mut self,
        place: u8,
        seen: Option<(bool, Stick)>,
        allowed: Allowed,
    ) -> Option<Order> {
        let by = By::Gamepad(place);
        let bit = 1_u8.checked_shl(place.into()).unwrap_or(0);
        let was_up = self.rested & bit != 0;
        self.rested &= !bit;
        match seen {
            Some((true, stick)) if was_up => self.press(by, stick, allowed),
            Some((true, stick)) => self.press(by, stick, &|| None),
            Some((false, _)) => {
                self.rested |= bit;
                self.release(by)
            }
            None => self.release(by),
        }
    }

    /// Releases all gamepads: a held one has to be pressed again.
    pub(crate) fn release_gamepads(&mut self) -> Option<Order> {
        self.rested = 0;
        self.down.retain(|by| !matches!(by, By::Gamepad(_)));
        let held = self.held.filter(|held| matches!(held.by, By::Gamepad(_)));
        held.and_then(|_| self.end())
    }

    /// What changed since the last frame of the screen.
    pub(crate) fn frame(&mut self) -> Option<Order> {
        let held = self.held.as_mut()?;
        let wheels = held.stick.wheels(held.limit_rpm);
        if wheels == held.sent {
            return None;
        }
        held.sent = wheels;
        Some(Order::Adjust(wheels))
    }

    /// Ends the hold although the stick may still be held: the bus refused a command or stopped the group.
    pub(crate) fn end(&mut self) -> Option<Order> {
        self.held.take().map(|_| Order::Stop)
    }

    /// The same when releases of keys may be missed: the pad or the page has lost the focus, or Meta is down,
    /// during which macOS reports no releases.
    pub(crate) fn leave(&mut self) -> Option<Order> {
        self.arrows = [false; 4];
        self.down.retain(|by| *by != By::Keys);
        self.end()
    }

    /// All motors are stopped: ends the hold without another stop.
    pub(crate) fn stopped(&mut self) {
        self.held = None;
    }
}

#[cfg(test)]
#[path = "pad_tests.rs"]
mod tests;
