//! The tab `Code`: the sequence of the tab `Sequence` as a program, or the vehicle as a setup for ROS 2.

use leptos::{prelude::*, task::spawn_local};
use motorlink_i18n::tr;
use motorlink_messages::{
    experiments::{
        generate::{Program, Ros2, arduino, python, ros2, rust},
        plan::Plan,
    },
    protocol::{MotorId, family::Model},
};
use wasm_bindgen_futures::JsFuture;

use crate::{
    features::experiments::{
        results::save_text,
        state::{Draft, Experiments},
        texts,
    },
    model::names_and_sides::Side,
    ui::{
        button::PressButton,
        reactive::{dynamic, handler},
    },
};

/// The port in the program. The user replaces it.
const PORT: &str = "/dev/ttyUSB0";
/// Distance between the wheels and their radius in the files for ROS 2, in m: those of the page's small rover. The user
/// replaces them.
const SEPARATION_M: f64 = 0.3;
const RADIUS_M: f64 = 0.0503;

/// A language.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Code {
    Python,
    Arduino,
    Rust,
    Ros2,
}

impl Code {
    const ALL: [Self; 4] = [Self::Python, Self::Arduino, Self::Rust, Self::Ros2];

    const fn name(self) -> &'static str {
        match self {
            Self::Python => "Python",
            Self::Arduino => "Arduino",
            Self::Rust => "Rust",
            Self::Ros2 => "ROS 2",
        }
    }
}

/// The files of a program: names and contents. Or why there is none.
type Files = Result<Vec<(&'static str, String)>, String>;

fn files(of: Experiments, code: Code) -> Files {
    // Another model has other frames, and speeds in other units.
    if of.page.model.get() != Model::Ddsm115 {
        return Err(
            tr!("The code is for the DDSM115. Choose that model in the settings.").to_owned(),
        );
    }
    if code == Code::Ros2 {
        return robot(of);
    }
    let sequence = of.draft.with(Draft::sequence);
    let refused = |error| texts::refused(&error, None);
    let mut sequence = sequence.map_err(refused)?;
    sequence.limits = of.limits(sequence.limits);
    let plan = of.fleet.with(|fleet| Plan::new(&sequence, fleet));
    let plan = plan.map_err(refused)?;
    let program = Program {
        plan: &plan,
        name: &sequence.name,
        port: PORT,
    };
    Ok(match code {
        Code::Python => vec![("motorlink.py", python(&program))],
        Code::Arduino => vec![("motorlink.ino", arduino(&program))],
        Code::Rust | Code::Ros2 => {
            let files = rust(&program);
            vec![("Cargo.toml", files.manifest), ("main.rs", files.main)]
        }
    })
}

/// The first motor of each side.
fn robot(of: Experiments) -> Files {
    let first = |side: Side| -> Option<MotorId> {
        of.page.motors.names.with(|names| {
            let mut members = names.members();
            members.find(|(_, it)| it.side == side).map(|(id, _)| *id)
        })
    };
    let (Some(left), Some(right)) = (first(Side::Left), first(Side::Right)) else {
        let words = tr!("Set the sides of two motors first: one left, one right.");
        return Err(words.to_owned());
    };
    let files = ros2(&Ros2 {
        port: PORT,
        left,
        right,
        wheel_separation_m: SEPARATION_M,
        wheel_radius_m: RADIUS_M,
        rpm_max: of.fleet.with(|fleet| fleet.rpm_max),
    });
    Ok(vec![
        ("controllers.yaml", files.controllers_yaml),
        ("ros2_control.urdf", files.urdf),
    ])
}

/// The files below each other, each under its name if there are several.
fn text(files: &Files) -> String {
    match files {
        Err(why) => why.clone(),
        Ok(files) => match files.as_slice() {
            [(_, text)] => text.clone(),
            files => {
                let one = |(name, text): &(&str, String)| format!("==== {name} ====\n{text}");
                files.iter().map(one).collect::<Vec<_>>().join("\n")
            }
        },
    }
}

/// The tab without its frame.
#[component]
pub(crate) fn CodeTab(of: Experiments) -> impl IntoView {
    let code = RwSignal::new(0_usize);
    let chosen = move || Code::ALL.get(code.get()).copied().unwrap_or(Code::Python);
    let said = RwSignal::new(String::new());
    let now = move || files(of, chosen());
    let none = Signal::derive(move || now().err());
    let copy = move || {
        let program = untrack(|| text(&now()));
        spawn_local(async move {
            // Over plain HTTP there is no clipboard.
            let is_copied = window().is_secure_context()
                && JsFuture::from(window().navigator().clipboard().write_text(&program))
                    .await
                    .is_ok();
            let words = if is_copied {
                tr!("Copied")
            } else {
                tr!("The browser does not allow this. Select the program and copy it.")
            };
            let _ = said.try_set(words.to_owned());
        });
    };
    let save = move || {
        for (name, text) in untrack(now).into_iter().flatten() {
            save_text(&text, name);
        }
    };
    let options = Code::ALL.into_iter().enumerate();
    let options = options.map(|(place, code)| {
        view! { <option value=place.to_string()>{code.name()}</option> }
    });
    view! {
        <div class="experiment-ask">
            <label class="ask-field">
                <span class="field-name">{tr!("Language of the code")}</span>
                <select
                    aria-label=tr!("Language of the code")
                    on:change=handler(move |event| {
                        if let Ok(place) = event_target_value(&event).parse() {
                            code.set(place);
                        }
                    })
                >
                    {options.collect_view()}
                </select>
            </label>
            <p class="experiment-advice">
                {tr!(
                    "The sequence of the tab Sequence as a program. It asks before it moves anything, and stops the motors at its end, on an error and on Ctrl-C."
                )}
            </p>
            <div class="button-row">
                <PressButton
                    label=tr!("Copy")
                    class="button small"
                    disabled_reason=none
                    on_press=copy
                />
                <PressButton
                    label=tr!("Save")
                    class="button small"
                    disabled_reason=none
                    on_press=save
                />
            </div>
            <p role="status" class="run-said">{dynamic(move || said.get())}</p>
        </div>
        <div class="experiment-curves">
            <textarea
                class="code-text"
                readonly
                spellcheck="false"
                wrap="off"
                aria-label=tr!("Program")
                prop:value=dynamic(move || text(&now()))
            ></textarea>
        </div>
    }
}
