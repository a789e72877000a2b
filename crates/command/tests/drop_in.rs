//! The command lines of the documentation of m0601-cli 0.1.1, with `motorlink` in the place of `m0601`. What would run until
//! Ctrl-C ends after a moment here.

use crate::bench::Bench;

#[test]
fn scripts_for_m0601_cli_run() {
    let bench = Bench::new(&[]);
    let log = bench.file("log.csv");
    let lines = [
        "scan".to_owned(),
        "scan --full".to_owned(),
        "info".to_owned(),
        "--id 0x01 --timeout 0.15 info".to_owned(),
        "info --id 1 --timeout 0.15".to_owned(),
        "monitor --hz 5 --secs 0.3".to_owned(),
        format!("monitor --csv {log} --format article --secs 0.5"),
        "drive velocity --rpm 100 --secs 0.5".to_owned(),
        "drive velocity --rpm -50 --accel 1 --secs 0.3".to_owned(),
        "drive current --amps 0.3 --secs 0.2".to_owned(),
        "drive position --deg 180 --secs 0.5".to_owned(),
        "set-id --new 0x02 --yes".to_owned(),
    ];
    for line in lines {
        let said = bench.run(&line);
        assert_eq!(said.code, Some(0), "{line}: {said:?}");
    }
    let rows = std::fs::read_to_string(log).unwrap();
    let columns = "timestamp,motor_id,mode,speed_rpm,current_a,temp_c,position_deg,error_code,error_str,raw_hex";
    assert_eq!(rows.lines().next(), Some(columns));
    assert!(rows.lines().count() > 2, "{rows}");
}

#[test]
fn raw_frames_are_sent_and_what_moves_needs_a_yes() {
    let bench = Bench::new(&[]);
    let raw = |flags: &[&str], bytes: &str| {
        let mut command = bench.command("raw");
        crate::bench::Said::of(command.args(flags).arg(bytes).output().unwrap())
    };
    let query = raw(&[], "01 74 00 00 00 00 00 00 00");
    assert_eq!(query.code, Some(0), "{query:?}");
    assert!(
        query.out.contains("TX: 01 74 00 00 00 00 00 00 00 04"),
        "{query:?}"
    );
    assert!(query.out.contains("RX: 01 02"), "{query:?}");
    let motion = "01 64 00 64 00 00 03 00 00";
    let refused = raw(&[], motion);
    assert_eq!(refused.code, Some(2), "{refused:?}");
    let sent = raw(&["--yes"], motion);
    assert_eq!(sent.code, Some(0), "{sent:?}");
    assert!(sent.err.contains("stands, confirmed"), "{sent:?}");
    assert_eq!(raw(&[], "01 74").code, Some(2));
}

#[test]
fn a_raw_reply_is_explained_as_one_of_its_model() {
    let bench = Bench::new(&["--model", "ddsm210"]);
    let mut command = bench.command("--model ddsm210 raw");
    let said = command.arg("01 74 00 00 00 00 00 00 00").output().unwrap();
    let said = crate::bench::Said::of(said);
    assert!(said.out.contains(" turns, "), "{said:?}");
}

#[test]
fn bad_command_lines_are_one_line_and_exit_code_2() {
    let bench = Bench::new(&[]);
    for line in [
        "drive velocity",
        "drive velocity 1000",
        "drive current --amps 9",
        "drive position 361",
        "drive velocity 50 --secs -1",
        "drive velocity 50 --rate 501",
        "--id 0 info",
        "--id 255 info",
        "set-id --new 200",
        "--virtual --port /dev/null info",
        "frobnicate",
    ] {
        let said = bench.run(line);
        assert_eq!(said.code, Some(2), "{line}: {said:?}");
        assert_eq!(said.err.lines().count(), 1, "{line}: {said:?}");
    }
}
