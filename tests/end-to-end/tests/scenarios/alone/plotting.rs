//! A recording is exported in both forms: the columns of the article, and for plotting.

use std::{thread, time::Duration};

use anyhow::{Context, Result};

use crate::fixture::{
    Scenario, assert_quiet_console,
    exports::{Reply, TELEMETRY_HEAD, Table, hex, ms_of_day, undisturbed_replies},
    stop_and_release, wait_for_speed,
};
use end_to_end::Frame;

/// The columns of one motor.
const PLOT_HEAD: [&str; 10] = [
    "time",
    "motor_1_unmirrored_speed_rpm",
    "motor_1_unmirrored_current_a",
    "motor_1_unmirrored_position_deg",
    "motor_1_temperature_c",
    "motor_1_mode",
    "motor_1_fault_code",
    "motor_1_unmirrored_setpoint",
    "motor_1_setpoint_mode",
    "motor_1_unmirrored_current_raw",
];

/// A drive, another one and a stop.
fn record(scenario: &Scenario) -> Result<()> {
    let page = &scenario.page;
    page.open_panel("Recording")?;
    page.click("button", "Record telemetry")?;
    page.open_panel("Control")?;
    thread::sleep(Duration::from_millis(500));
    page.click("button", "-50")?;
    wait_for_speed(page, -53..=-47)?;
    stop_and_release(page)?;
    page.open_panel("Recording")?;
    page.click("button", "Stop recording")?;
    Ok(())
}

/// The replies on the wire that the rows are.
fn run_of<'a>(replies: &'a [Reply], raw: &[&str]) -> Result<&'a [Reply]> {
    let is_run = |run: &&[Reply]| {
        let mut pairs = run.iter().zip(raw);
        pairs.all(|(reply, row)| hex(&reply.frame) == **row)
    };
    let run = replies.windows(raw.len()).find(is_run);
    run.context("the rows are no run of replies without a gap")
}

/// `0.004000` in microseconds.
fn micros(seconds: &str) -> Result<u64> {
    let (whole, fraction) = seconds.split_once('.').context("no decimal point")?;
    anyhow::ensure!(fraction.len() == 6, "{seconds}");
    Ok(whole.parse::<u64>()? * 1_000_000 + fraction.parse::<u64>()?)
}

/// The last drive frame before a reply: its setpoint, and how old it is.
fn commanded(host: &[Frame], reply: &Reply) -> Result<(i16, u64)> {
    let before = host.get(..reply.behind).context("no frame before it")?;
    let drive = |frame: &Frame| Some((frame.drive_setpoint()?, frame.at_us));
    let (setpoint, at_us) = before.iter().rev().find_map(drive).context("no drive")?;
    Ok((setpoint, reply.frame.at_us - at_us))
}

#[test]
fn a_recording_is_exported_for_plotting_with_commanded_beside_measured_values() -> Result<()> {
    let scenario = Scenario::spinning()?;
    let page = &scenario.page;
    record(&scenario)?;
    let article = Table::read(&page.download("Export telemetry CSV")?)?;
    let file = page.download("Plot CSV")?;
    assert!(file.name.starts_with("motorlink-plot-"), "{}", file.name);
    let plot = Table::read(&file)?;
    assert_eq!(article.head, TELEMETRY_HEAD);
    assert_eq!(plot.head, PLOT_HEAD);
    assert_eq!(plot.rows.len(), article.rows.len());

    // The same values, and the same time counted from the first row.
    let first_ms = ms_of_day(&article.rows[0][0])?;
    for (plot, article) in plot.rows.iter().zip(&article.rows) {
        let elapsed_ms = micros(&plot[0])? / 1_000;
        let ms = ms_of_day(&article[0])? - first_ms;
        assert!(elapsed_ms.abs_diff(ms) <= 1, "{plot:?} {article:?}");
        let [_, _, _, speed, current, temperature, position, ..] = &article[..] else {
            panic!("{article:?}");
        };
        assert_eq!(
            plot[1..5],
            [speed, current, position, temperature].map(String::as_str)
        );
        assert_eq!(plot[5..7], ["2", "0"], "velocity loop, no fault");
    }
    let times = plot.column("time")?;
    let times: Vec<u64> = times.into_iter().map(micros).collect::<Result<_>>()?;
    assert!(times[0] == 0 && times.is_sorted(), "{times:?}");

    // Beside each reply stands the setpoint that the motor had been told.
    let wire = scenario.adapter.wire()?;
    let replies = undisturbed_replies(&wire);
    let run = run_of(&replies, &article.column("raw_hex")?)?;
    let host = wire.from_host().frames;
    for (row, reply) in plot.rows.iter().zip(run) {
        let (setpoint, age_us) = commanded(&host, reply)?;
        let cells = [row[7].as_str(), row[8].as_str()];
        let rpm = setpoint.to_string();
        let told = [rpm.as_str(), "2"];
        // Nothing is commanded from 1.5 s after the stop on. The clocks differ by what a line takes.
        match age_us {
            ..1_450_000 => assert_eq!(cells, told, "{row:?}"),
            1_550_000.. => assert_eq!(cells, ["", ""], "{row:?}"),
            _ => assert!(cells == told || cells == ["", ""], "{row:?}"),
        }
    }
    let setpoints = plot.column("motor_1_unmirrored_setpoint")?;
    for setpoint in ["100", "-50", "0"] {
        assert!(setpoints.contains(&setpoint), "{setpoint}: {setpoints:?}");
    }
    assert_quiet_console(page);
    Ok(())
}
