//! The group of motors with sides as a vehicle, and its measures. A person enters them once, and the browser stores
//! them.

use std::cell::Cell;

use leptos::prelude::*;
use motorlink_messages::{
    experiments::vehicle::{Geometry, Vehicle, Wheel},
    protocol::MotorId,
};

use crate::model::{
    local_storage::{remember, remembered},
    names_and_sides::{NameAndSide, NamesAndSides, Side},
    page::{Change, Listener, Page},
};

/// The storage key of the measures.
const STORED_AS: &str = "rover";

/// The motors of the group that have a side, each side in the order of IDs, from the front to the rear; `None` unless
/// the group has a wheel on either side.
pub(crate) fn vehicle_of(names: &NamesAndSides) -> Option<Vehicle> {
    let members = names.members().filter(|(_, member)| member.drives);
    let wheel = |(id, member): &(MotorId, NameAndSide)| {
        Some(Wheel {
            id: *id,
            is_right: match member.side {
                Side::None => return None,
                Side::Left => false,
                Side::Right => true,
            },
            name: member.name().trim().to_owned(),
        })
    };
    Vehicle::new(members.filter_map(wheel).collect())
}

thread_local! {
    /// The measures in use, from their first use on. The browser may store none, and another tab may store others.
    static IN_USE: Cell<Option<Geometry>> = const { Cell::new(None) };
}

/// The measures in use, or those that would be.
pub(crate) fn measures() -> Geometry {
    IN_USE.get().unwrap_or_else(stored)
}

/// The same as a signal: made at the first call, for the owner of the page.
pub(crate) fn geometry_of_page(owner: &Owner, page: Page) -> RwSignal<Geometry> {
    #[derive(Clone, Copy)]
    struct InUse(RwSignal<Geometry>);
    owner.with(|| {
        let in_use = use_context::<InUse>().unwrap_or_else(|| {
            IN_USE.set(Some(measures()));
            on_cleanup(|| IN_USE.set(None));
            let geometry = RwSignal::new(measures());
            let take = move |change: Change<'_>| {
                if matches!(change, Change::Geometry) {
                    geometry.set(measures());
                }
            };
            page.listen(Listener::Geometry, Box::new(take));
            provide_context(InUse(geometry));
            InUse(geometry)
        });
        in_use.0
    })
}

/// What this browser has stored, or the defaults.
fn stored() -> Geometry {
    let stored = remembered(STORED_AS);
    stored.and_then(|text| from_text(&text)).unwrap_or_default()
}

/// Uses them from now on, and stores them in this browser.
pub(crate) fn save(geometry: Geometry) {
    IN_USE.set(Some(geometry));
    remember(STORED_AS, &to_text(geometry));
}

/// `51 300`: radius and track in mm.
fn to_text(geometry: Geometry) -> String {
    let [radius, track] = geometry.entered();
    format!("{radius} {track}")
}

fn from_text(text: &str) -> Option<Geometry> {
    let (radius, track) = text.split_once(' ')?;
    Geometry::new(radius.parse().ok()?, track.parse().ok()?)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::model::scan_texts::tests::id;

    /// Odd IDs are left wheels, even ones right wheels.
    pub(crate) fn names(count: u8) -> NamesAndSides {
        let mut names = NamesAndSides::default();
        for number in 1..=count {
            names.change(id(number), |member| {
                member.drives = true;
                member.side = if number % 2 == 0 {
                    Side::Right
                } else {
                    Side::Left
                };
            });
        }
        names
    }

    #[test]
    fn a_vehicle_has_a_wheel_on_either_side() {
        let wheels = |names: &NamesAndSides| vehicle_of(names).map(|it| it.wheels().len());
        assert_eq!(wheels(&names(2)), Some(2));
        assert_eq!(wheels(&names(1)), None, "no right wheel");
        assert_eq!(wheels(&NamesAndSides::default()), None);
        let mut names = names(4);
        names.change(id(3), |member| member.side = Side::None);
        assert_eq!(wheels(&names), Some(3), "without a side it is no wheel");
        names.change(id(1), |member| member.drives = false);
        assert_eq!(
            wheels(&names),
            None,
            "motors outside the group are no wheels"
        );
    }

    /// Commands, the path and exported files have one sign.
    #[test]
    fn a_wheel_turns_forward_where_a_mirrored_motor_does() {
        let names = names(4);
        for wheel in vehicle_of(&names).unwrap().wheels() {
            let is_mirrored = names.mirror(wheel.id).is_mirrored();
            assert_eq!(wheel.forward_sign() < 0.0, is_mirrored, "{wheel:?}");
        }
    }

    #[test]
    fn what_is_stored_is_loaded_and_garbage_is_not() {
        let geometry = Geometry::new(60, 420).unwrap();
        assert_eq!(from_text(&to_text(geometry)), Some(geometry));
        for text in [
            "", "51", "51 ", "9 300", "51 49", "51 3001", "-51 300", "51 300 1",
        ] {
            assert_eq!(from_text(text), None, "{text:?}");
        }
        let default = Geometry::default();
        assert_eq!(from_text(&to_text(default)), Some(default));
    }
}
