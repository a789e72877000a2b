//! The messages of the panel: the running activity, its outcome, or what to do next.

use motorlink_i18n::tr;
use motorlink_messages::protocol::family::Model;

use crate::{
    features::wheel_setup::{
        state::{Activity, Outcome, Setup, Step},
        wheel::{Problem, WHEELS_MAX, Wheel},
    },
    model::{
        id_progress::IdProgress,
        notice_board::{NoticeText, Tone, Topic},
        terms,
    },
};

/// The message of the panel.
pub(crate) fn message(setup: &Setup, ids: &IdProgress) -> NoticeText {
    match setup.activity {
        Activity::None => after(setup),
        Activity::Finding => calm(
            ids.message.title.clone(),
            &[tr!(
                "Running motors are stopped first. You confirm before the ID changes."
            )],
        ),
        Activity::Checking => calm(tr!("Checking which motors reply"), &[]),
        Activity::Spinning(place) => calm(
            tr!("{name} turns", name = name(setup, place)),
            &[tr!("STOP, Space and Escape stop it at once.")],
        ),
        Activity::Stopping(place) => {
            calm(tr!("{name} is stopping", name = name(setup, place)), &[])
        }
        Activity::Answering { wheel, .. } => calm(
            tr!("What did you see?"),
            &[&tr!(
                "{name} should have turned forward, as when the rover drives forward.",
                name = name(setup, wheel)
            )],
        ),
    }
}

/// The outcome of the last activity, or what to do in this step.
fn after(setup: &Setup) -> NoticeText {
    match &setup.outcome {
        Outcome::Nothing => to_do(setup),
        Outcome::Problem(problem) => of_problem(problem),
        Outcome::Ids(text) => text.clone(),
        Outcome::Several(motors) => warning(
            tr!(
                "{count} motors found ({ids})",
                count = motors.len(),
                ids = terms::ids(motors)
            ),
            &[tr!(
                "A new ID reaches every motor on the bus. Unplug all motors but this one, then \
                 press Find and set ID again."
            )],
        ),
        Outcome::Kept(more) => {
            let power = tr!(
                "A motor takes one new ID per power-up. Switch its power off and on, then press \
                 Find and set ID again."
            );
            let more = more.map(|more| {
                tr!(
                    "Or press Send {count} frames: some motors need more.",
                    count = more.count()
                )
            });
            let advice: Vec<&str> = [power].into_iter().chain(more.as_deref()).collect();
            warning(tr!("The motor has kept its ID"), &advice)
        }
        Outcome::Cancelled => calm(
            tr!("Cancelled: no ID was set"),
            &[tr!("Press Find and set ID again.")],
        ),
        Outcome::Disconnected => warning(
            tr!("The connection was closed"),
            &[tr!("Connect again. The setup continues at this step.")],
        ),
        Outcome::Refused(reason) => warning(tr!("Not done"), &[reason]),
        Outcome::StoppedEarly(place) => warning(
            tr!("{name} was stopped early", name = name(setup, *place)),
            &[tr!("The notices say why. Press Spin again.")],
        ),
        Outcome::NotConfirmed(id) => NoticeText {
            tone: Tone::Error,
            ..warning(
                tr!("Motor {id} did not confirm the stop", id),
                &[tr!("If the wheel turns, switch off the power.")],
            )
        },
        Outcome::SideChanged(place) => calm(
            tr!("{name}: side changed", name = name(setup, *place)),
            &[&tr!(
                "Side: {side}. Spin it again to check the direction.",
                side = setup
                    .wheels
                    .get(*place)
                    .map_or("", |wheel| wheel.side.words())
            )],
        ),
        Outcome::Exchanged(one, other) => calm(
            tr!(
                "The motors of {one} and {other} are swapped",
                one = name(setup, *one),
                other = name(setup, *other)
            ),
            &[tr!(
                "Each motor keeps its ID and label. Spin both wheels again."
            )],
        ),
        Outcome::NothingTurned(place) => warning(
            tr!("{name} did not turn", name = name(setup, *place)),
            &[tr!(
                "Check that the wheel is free and that the motor reports no fault, then spin it \
                 again."
            )],
        ),
    }
}

/// What to do in a step.
fn to_do(setup: &Setup) -> NoticeText {
    let count = setup.wheels.len();
    match setup.step {
        Step::Wheels => calm(
            tr!("Enter the wheels"),
            &[tr!("Choose a layout. Names, sides and IDs can be changed.")],
        ),
        Step::Id(place) => calm(
            tr!(
                "Connect only the motor of {name}",
                name = name(setup, place)
            ),
            &[tr!(
                "Switch the power off, unplug all other motors, and switch it on. Then press Find \
                 and set ID."
            )],
        ),
        Step::Label(place) => calm(
            tr!(
                "{name} has ID {id}",
                name = name(setup, place),
                id = id_of(setup, place)
            ),
            &[],
        ),
        Step::Check => of_check(setup, count),
        Step::Spin if setup.wheels.iter().all(|wheel| wheel.is_checked) => calm(
            tr!("All {count} wheels are checked", count),
            &[tr!("Press Finish.")],
        ),
        Step::Spin => calm(
            tr!("Lift the rover, then spin each wheel"),
            &[tr!(
                "A wheel turns slowly for half a second, forward. Keep fingers clear."
            )],
        ),
        Step::Done => calm(
            tr!("{count} wheels are set up", count),
            &[tr!(
                "Names, sides and the group are stored in this browser. Export setup in Settings \
                 saves them to a file."
            )],
        ),
    }
}

fn of_check(setup: &Setup, count: usize) -> NoticeText {
    if setup.answered.is_none() {
        return calm(
            tr!("Connect all {count} motors to one bus", count),
            &[tr!(
                "Switch the power off before you plug them in. Then switch it on and press Check \
                 all."
            )],
        );
    }
    let others = setup.unassigned_motors();
    let others = (!others.is_empty())
        .then(|| tr!("Other motors also reply: {ids}.", ids = terms::ids(&others)));
    let is_missing = |wheel: &&Wheel| setup.has_answered(wheel) == Some(false);
    let missing: Vec<String> = setup
        .wheels
        .iter()
        .filter(is_missing)
        .map(|wheel| {
            let id = wheel.motor().map(|id| id.to_string());
            [&*wheel.name, " (", &id.unwrap_or_default(), ")"].concat()
        })
        .collect();
    if missing.is_empty() {
        let next = tr!("Press Continue to check place and direction of each wheel.");
        let advice: Vec<&str> = others.as_deref().into_iter().chain([next]).collect();
        return calm(tr!("All {count} motors reply", count), &advice);
    }
    let check = tr!("Check their power and plugs, then press Check all again.");
    let set_id = tr!("If the motor has another ID, press Set ID beside its wheel.");
    let advice: Vec<&str> = [check, set_id]
        .into_iter()
        .chain(others.as_deref())
        .collect();
    warning(
        tr!("No reply from {wheels}", wheels = missing.join(", ")),
        &advice,
    )
}

fn of_problem(problem: &Problem) -> NoticeText {
    let words = match problem {
        Problem::NoWheels => tr!("Add a wheel.").to_owned(),
        Problem::TooMany => tr!("At most {count} wheels drive together.", count = WHEELS_MAX),
        Problem::Name(place) => tr!("Enter a name for wheel {number}.", number = place + 1),
        Problem::SameName(name) => tr!("Two wheels are called {name}. Change one of them.", name),
        Problem::Id(place) => tr!(
            "Enter an ID from 1 to 254 for wheel {number}. 200 is reserved.",
            number = place + 1
        ),
        Problem::SameId(id) => tr!("Two wheels have ID {id}. Change one of them.", id),
    };
    warning(tr!("The wheels are not complete"), &[&words])
}

/// What to do with a motor after it got its ID.
pub(crate) fn of_label(model: Model) -> String {
    tr!(
        "Put the label on the motor. Switch the power off before you unplug it. A {model} takes one \
         new ID per power-up: to change this one again, switch it off and on first.",
        model = model.spec().name
    )
}

fn name(setup: &Setup, place: usize) -> &str {
    setup
        .wheels
        .get(place)
        .map_or("", |wheel| wheel.name.trim())
}

/// Why a button is disabled while the page asks about a wheel.
pub(crate) fn must_answer() -> &'static str {
    tr!("First choose what you saw.")
}

/// The ID of a wheel's motor: `0x03`.
pub(crate) fn id_of(setup: &Setup, place: usize) -> String {
    let wheel = setup.wheels.get(place);
    let id = wheel.and_then(Wheel::motor);
    id.map(|id| id.to_string()).unwrap_or_default()
}

fn calm(title: impl Into<String>, advice: &[&str]) -> NoticeText {
    NoticeText::new(Topic::Survey, Tone::Calm, title, advice)
}

fn warning(title: impl Into<String>, advice: &[&str]) -> NoticeText {
    NoticeText::new(Topic::Survey, Tone::Warning, title, advice)
}
