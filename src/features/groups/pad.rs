//! Hold to run: a vehicle of two sides is driven for as long as somebody holds a stick.
//!
//! The stick is a pointer on the pad, the arrow keys or a gamepad, and whoever presses first has it.
//! A hold begins by a press and by nothing else. When it has ended, for whatever reason, the same
//! stick has to be let go and pressed anew: a finger that still moves starts nothing.

use crate::model::fleet::Wheels;

/// Whatever is nearer to the middle, of the whole way, is the middle: no stick comes back exactly.
const DEAD: f64 = 0.08;

/// As many gamepads are looked at as browsers tell of.
pub(crate) const GAMEPADS_MAX: u8 = 4;

/// The arrow keys, in the order of [`DrivePad::arrows`].
const ARROWS: [&str; 4] = ["ArrowUp", "ArrowDown", "ArrowLeft", "ArrowRight"];

/// Where the stick is, each -1 to 1 of the way to the edge.
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
                way.clamp(-1.0, 1.0)
            } else {
                0.0
            }
        };
        Self {
            forward: part(forward),
            turn: part(turn),
        }
    }

    /// The speeds of both sides. Where forward and turn together ask for more than there is, both
    /// sides give way alike, so that the vehicle keeps its curve.
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

/// Whose stick it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum By {
    /// A pointer with this number.
    Pointer(i32),
    /// The arrow keys, all of them as one.
    Keys,
    /// The gamepad at this place, 0 to [`GAMEPADS_MAX`] - 1.
    Gamepad(u8),
}

/// What the bus is to be told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Order {
    /// Drive all members.
    Start(Wheels),
    /// Drive them otherwise, if they are driven.
    Adjust(Wheels),
    /// Stop them.
    Stop,
}

/// Whether driving may begin now, and how fast at most, in rpm. Asked at a press only.
pub(crate) type Allowed<'a> = &'a dyn Fn() -> Option<i32>;

/// The pad.
#[derive(Debug, Default)]
pub(crate) struct DrivePad {
    held: Option<Held>,
    /// Keys and gamepads that have not been let go since they were pressed. A pointer is not among
    /// them: its press is an event of its own, not a state.
    down: Vec<By>,
    arrows: [bool; 4],
    /// Gamepads that were seen with their button up, a bit each: only these can be pressed.
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

    /// Where the stick is while it drives, and what was sent for it.
    pub(crate) fn driving(&self) -> Option<(Stick, Wheels)> {
        self.held.map(|held| (held.stick, held.sent))
    }

    /// The stick is pressed. It begins a hold if nobody else holds the pad and driving is allowed.
    ///
    /// A pointer that holds the pad was let go before it is pressed again, and that was not heard.
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

    /// The stick moves; [`DrivePad::frame`] tells the bus.
    pub(crate) fn steer(&mut self, by: By, moved: Stick) {
        if let Some(held) = self.held.as_mut().filter(|held| held.by == by) {
            held.stick = moved;
        }
    }

    /// The stick is let go.
    pub(crate) fn release(&mut self, by: By) -> Option<Order> {
        self.down.retain(|down| *down != by);
        let held = self.held.filter(|held| held.by == by);
        held.and_then(|_| self.end())
    }

    /// An arrow key goes down or up; a key that repeats does neither.
    ///
    /// One that goes down twice came up unheard, and others may have too: that is a release, not a press.
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

    /// A gamepad is looked at: whether its button is down, and its stick; `None` where there is none.
    ///
    /// A button that is down when it is first seen was not pressed here, so it starts nothing.
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

    /// The gamepads are looked at no more.
    pub(crate) fn stop_polling_gamepads(&mut self) -> Option<Order> {
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

    /// The hold is over though the stick may still be held: the bus refused it, or did not go on.
    pub(crate) fn end(&mut self) -> Option<Order> {
        self.held.take().map(|_| Order::Stop)
    }

    /// The same where keys that come up will not be heard: the pad has lost the focus, or the page, or Meta
    /// is down, with which macOS tells of no other key that comes up.
    pub(crate) fn leave(&mut self) -> Option<Order> {
        self.arrows = [false; 4];
        self.down.retain(|by| *by != By::Keys);
        self.end()
    }

    /// All motors are stopped: the hold is over, and there is nobody left to stop.
    pub(crate) fn stopped(&mut self) {
        self.held = None;
    }
}

#[cfg(test)]
#[path = "pad_tests.rs"]
mod tests;
