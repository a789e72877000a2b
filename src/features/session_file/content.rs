//! What is in an open file: what is missing, figures, a picture, events, and exports.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{
    protocol::{Current, Rpm},
    sessions::{SessionExport, SessionInfo, SessionMotor},
};

use crate::{
    features::session_file::{actions::SessionFiles, events::events, texts, timeline::timeline},
    model::terms,
    ui::{
        button::PressButton,
        clock::{local_date, local_time},
        format::{self, grouped},
        reactive::dynamic,
    },
};

/// The content of an open file.
pub(super) fn content(files: SessionFiles, info: &SessionInfo) -> impl IntoView + use<> {
    let problems: Vec<_> = info
        .problems
        .iter()
        .map(|(problem, times)| view! { <li>{texts::of_problem(*problem, *times)}</li> })
        .collect();
    let has_no_problems = problems.is_empty();
    let facts: Vec<_> = facts(info)
        .into_iter()
        .map(|(name, value)| view! { <dt>{name}</dt> <dd>{value}</dd> })
        .collect();
    let motors: Vec<_> = info.motors.iter().map(motor_row).collect();
    let reads = move || {
        let reads = files.reading.get();
        reads.map(|_| tr!("Wait until the current task has finished.").to_owned())
    };
    let export = move |what, label, hint| {
        view! {
            <PressButton
                label=label
                class="button small"
                hint=hint
                disabled_reason=Signal::derive(reads)
                on_press=move || files.export(what)
            />
        }
    };
    view! {
        <div class="session-content">
            {head(files, info)}
            <ul class="session-problems" aria-label=tr!("Missing in the file") hidden=has_no_problems>
                {problems}
            </ul>
            <dl>{facts}</dl>
            <div class="session-pictures">{timeline(files.player, info)}</div>
            <table class="session-motors">
                <thead>
                    <tr>
                        <th scope="col">{tr!("Motor")}</th>
                        <th scope="col">{tr!("Speed")} " (" {format::rpm()} ")"</th>
                        <th scope="col">{tr!("Current" as "electric")} " (A)"</th>
                        <th scope="col">"°C"</th>
                        <th scope="col">{tr!("Lost")}</th>
                    </tr>
                </thead>
                <tbody>{motors}</tbody>
            </table>
            {events(files.player, info)}
            {runs(files, info, Signal::derive(reads))}
            <div class="button-row">
                <PressButton
                    label=tr!("Save copy")
                    class="button small"
                    hint=tr!("A copy of the file with the bookmarks. The file itself stays as it is.")
                    disabled_reason=Signal::derive(reads)
                    on_press=move || files.save_copy()
                />
                {export(
                    SessionExport::Report,
                    tr!("Report"),
                    tr!("One HTML file: duration, motors, faults, stops, losses, extremes, graphs"),
                )}
                {export(
                    SessionExport::Plot,
                    tr!("Export plot CSV"),
                    tr!("Every reply with elapsed seconds, for PlotJuggler"),
                )}
                {export(
                    SessionExport::Log,
                    tr!("Export log"),
                    tr!("The packet log as CSV"),
                )}
            </div>
        </div>
    }
}

/// The runs of experiments in the file.
fn runs(
    files: SessionFiles,
    info: &SessionInfo,
    reads: Signal<Option<String>>,
) -> impl IntoView + use<> {
    let rows = info
        .runs
        .iter()
        .map(|name| view! { <li>{name.clone()}</li> });
    let more = (info.runs_left_out > 0).then(|| {
        tr!(
            "More runs in the file: {count}",
            count = grouped(info.runs_left_out)
        )
    });
    view! {
        <div class="session-runs" hidden=info.runs.is_empty()>
            <h4>{tr!("Runs of experiments")}</h4>
            <ul aria-label=tr!("Runs of experiments")>{rows.collect_view()}</ul>
            <p class="quiet">{more}</p>
            <PressButton
                label=tr!("Keep these runs")
                class="button small"
                hint=tr!("Adds them with their data to the tab Runs of Experiments, where they are compared and exported.")
                disabled_reason=reads
                on_press=move || files.keep_runs()
            />
        </div>
    }
}

/// The name of the file, and what can be done with it.
fn head(files: SessionFiles, info: &SessionInfo) -> impl IntoView + use<> {
    let player = files.player;
    let replays = move || player.info.with(Option::is_some);
    let replay_blocked_by = move || player.blocked_by().filter(|_| !replays());
    view! {
        <div class="session-head">
            <h3>{info.name.clone()}</h3>
            <PressButton
                label=Signal::derive(move || {
                    let word = if replays() { tr!("End replay") } else { tr!("Replay") };
                    word.to_owned()
                })
                class="button small primary"
                hint=tr!("Shows the recording on all instruments. No motor is driven.")
                disabled_reason=Signal::derive(replay_blocked_by)
                on_press=move || if replays() { player.end() } else { player.begin(false) }
            />
            <PressButton
                label=tr!("Close file")
                class="button small"
                on_press=move || files.close()
            />
            <p class="quiet" hidden=dynamic(move || replay_blocked_by().is_none())>
                {dynamic(move || replay_blocked_by().unwrap_or_default())}
            </p>
        </div>
    }
}

#[allow(
    clippy::cast_precision_loss,
    reason = "milliseconds since 1970 are exact in a double"
)]
fn facts(info: &SessionInfo) -> Vec<(&'static str, String)> {
    let from_ms = info.from_unix_us as f64 / 1_000.0;
    let from = format!("{} {}", local_date(from_ms), local_time(from_ms));
    let mut facts = vec![
        (tr!("From"), from),
        (tr!("Duration"), texts::elapsed(info.duration_us)),
        (tr!("Sent"), grouped(info.sent)),
        (tr!("Received"), grouped(info.received)),
        (tr!("Lost"), grouped(info.lost)),
        (tr!("Pieces of invalid bytes"), grouped(info.junk)),
        (tr!("File size"), texts::size(info.bytes)),
    ];
    if !info.version.is_empty() {
        facts.push((tr!("Written by MotorLink"), info.version.clone()));
    }
    facts
}

fn motor_row(motor: &SessionMotor) -> impl IntoView + use<> {
    let extremes = |buckets: &[Option<[i16; 2]>]| {
        let buckets = buckets.iter().copied().flatten();
        buckets.reduce(|one, other| [one[0].min(other[0]), one[1].max(other[1])])
    };
    let speed = extremes(&motor.speeds);
    let speed = speed.map(|[least, most]| {
        range(
            &format::speed(Rpm::new(least)),
            &format::speed(Rpm::new(most)),
        )
    });
    let current = extremes(&motor.currents);
    let amps = |raw| format::current(Current::from_raw(raw));
    let current = current.map(|[least, most]| range(&amps(least), &amps(most)));
    let unknown = || format::UNKNOWN.to_owned();
    let faults = (!motor.faults.is_none()).then(|| terms::faults(motor.faults));
    view! {
        <tr>
            <th scope="row">{motor.id.to_string()} <span class="bad">{faults}</span></th>
            <td>{speed.unwrap_or_else(unknown)}</td>
            <td>{current.unwrap_or_else(unknown)}</td>
            <td>{motor.temperature_max_c.map_or_else(unknown, |degrees| degrees.to_string())}</td>
            <td>{grouped(motor.lost)}</td>
        </tr>
    }
}

fn range(least: &str, most: &str) -> String {
    if least == most {
        return least.to_owned();
    }
    tr!("{least} to {most}", least, most)
}
