//! Rows of counters and what they mean.

use super::*;

const ID: MotorId = MotorId::FIRST;

fn two() -> MotorId {
    MotorId::new(2).unwrap()
}

/// So many requests, of which these were not answered.
fn tally(asked: u32, silent: u32, garbled: u32) -> Tally {
    Tally {
        asked,
        answered: asked - silent - garbled,
        silent,
        garbled,
        ..Tally::default()
    }
}

/// A motor that stood all the time. One that answered nothing is silent.
fn standing(id: MotorId, recent: Tally) -> MotorFindings {
    let is_silent = recent.answered == 0;
    let [heard, quiet] = if is_silent {
        [Tally::default(), recent]
    } else {
        [recent, Tally::default()]
    };
    MotorFindings {
        id,
        recent,
        heard,
        quiet,
        silent: is_silent,
        loss_per_mille: u16::try_from(recent.lost_per_mille()).ok(),
        standing: recent,
        turning: Tally::default(),
    }
}

/// A motor that stood and turned.
fn moving(standing: Tally, turning: Tally) -> MotorFindings {
    MotorFindings {
        standing,
        turning,
        ..self::standing(ID, turning)
    }
}

fn line(motors: &[MotorFindings]) -> Findings {
    Findings {
        motors: motors.to_vec(),
        ..Findings::default()
    }
}

/// Motor 1 alone, which stood all the time.
fn alone(recent: Tally) -> Findings {
    line(&[standing(ID, recent)])
}

fn with_median(median_us: u32, findings: Findings) -> Findings {
    let round_trip = RoundTripStatus {
        median_us: Some(median_us),
        ..RoundTripStatus::default()
    };
    Findings {
        round_trip,
        ..findings
    }
}

/// A motor does not answer a damaged request.
#[test]
fn silences_alone_are_loss_and_silences_beside_bad_crcs_are_damage() {
    for (silent, garbled, cause) in [
        (137, 0, Diagnosis::Lost),
        (137, 8, Diagnosis::Lost),
        (80, 97, Diagnosis::Damaged),
        (0, 97, Diagnosis::Damaged),
    ] {
        let verdict = diagnose(&alone(tally(1_000, silent, garbled)));
        assert_eq!(verdict, Verdict::Faulty(vec![cause]), "{silent} {garbled}");
    }
}

#[test]
fn damage_while_a_wheel_turns_has_its_likely_cause() {
    for (name, findings, expected) in [
        (
            "damage while it turns",
            line(&[moving(tally(50, 0, 0), tally(600, 0, 60))]),
            vec![Diagnosis::NoiseGrowsWithSpeed],
        ),
        (
            "much damage while it turns",
            line(&[moving(tally(100, 0, 2), tally(600, 0, 400))]),
            vec![Diagnosis::NoiseGrowsWithSpeed],
        ),
        (
            "damage at rest and while it turns",
            line(&[moving(tally(100, 0, 10), tally(600, 0, 60))]),
            vec![Diagnosis::Damaged],
        ),
        (
            "damage while it turns, and it never stood",
            line(&[moving(tally(0, 0, 0), tally(600, 0, 60))]),
            vec![Diagnosis::Damaged],
        ),
        (
            "damage while both turn, of which one never stood",
            line(&[
                moving(tally(50, 0, 0), tally(600, 0, 60)),
                MotorFindings {
                    id: two(),
                    ..moving(tally(0, 0, 0), tally(600, 0, 60))
                },
            ]),
            vec![Diagnosis::NoiseGrowsWithSpeed],
        ),
        (
            "damage that grows with speed, and damage at rest too",
            line(&[
                moving(tally(50, 0, 0), tally(600, 0, 60)),
                MotorFindings {
                    id: two(),
                    ..moving(tally(100, 0, 10), tally(600, 0, 60))
                },
            ]),
            vec![Diagnosis::NoiseGrowsWithSpeed, Diagnosis::Damaged],
        ),
    ] {
        assert_eq!(diagnose(&findings), Verdict::Faulty(expected), "{name}");
    }
}

#[test]
fn what_happened_has_its_likely_cause() {
    let good = tally(100, 0, 0);
    let echo = |tally: Tally| Tally {
        echoed: tally.asked,
        ..tally
    };
    let foreign = |foreign: u32, recent: Tally| Findings {
        foreign,
        ..alone(recent)
    };
    for (name, findings, expected) in [
        ("nothing", alone(tally(9, 9, 0)), vec![Diagnosis::Nothing]),
        (
            "nothing but a byte of noise",
            alone(tally(20, 18, 2)),
            vec![Diagnosis::Nothing],
        ),
        (
            "nobody on an adapter that echoes",
            alone(echo(tally(9, 9, 0))),
            vec![Diagnosis::EchoOnly],
        ),
        (
            "garbage at rest",
            alone(tally(9, 0, 9)),
            vec![Diagnosis::SharedId(ID)],
        ),
        (
            "garbage but for those that happened to agree",
            alone(tally(100, 0, 80)),
            vec![Diagnosis::SharedId(ID)],
        ),
        (
            "garbage of one motor of two",
            line(&[standing(ID, good), standing(two(), tally(9, 0, 9))]),
            vec![Diagnosis::SharedId(two())],
        ),
        ("losses", alone(tally(100, 6, 0)), vec![Diagnosis::Lost]),
        (
            "a stranger beside a good line",
            foreign(100, good),
            vec![Diagnosis::Stranger],
        ),
        (
            "a stranger in place of the motor that was asked",
            foreign(9, tally(9, 9, 0)),
            vec![Diagnosis::Stranger, Diagnosis::Silent(ID)],
        ),
        (
            "silence behind a minute of replies",
            line(&[MotorFindings {
                silent: true,
                heard: tally(480, 0, 0),
                quiet: tally(20, 20, 0),
                ..standing(ID, tally(500, 20, 0))
            }]),
            vec![Diagnosis::Nothing],
        ),
        (
            "one of two is silent",
            line(&[standing(ID, good), standing(two(), tally(9, 9, 0))]),
            vec![Diagnosis::Silent(two())],
        ),
        (
            "replies of 16 ms",
            with_median(18_336, alone(good)),
            vec![Diagnosis::LatencyTimer],
        ),
        (
            "late replies in blocks of 32 bytes",
            Findings {
                blocks: 4,
                ..alone(Tally {
                    late: 75,
                    ..tally(100, 75, 0)
                })
            },
            vec![Diagnosis::Blocks],
        ),
        (
            "four motors whose replies are late",
            line(&[1, 2, 3, 4].map(|id| {
                let late = Tally {
                    late: 75,
                    ..tally(100, 75, 0)
                };
                standing(MotorId::new(id).unwrap(), late)
            })),
            vec![Diagnosis::LatencyTimer],
        ),
        (
            "replies of 16 ms, and many lost",
            with_median(16_000, alone(tally(100, 0, 20))),
            vec![Diagnosis::Damaged, Diagnosis::LatencyTimer],
        ),
    ] {
        assert_eq!(diagnose(&findings), Verdict::Faulty(expected), "{name}");
    }
}

#[test]
fn nothing_is_diagnosed_of_little_or_of_chance() {
    let good = tally(100, 0, 0);
    for (name, findings, expected) in [
        ("nobody is asked", line(&[]), Verdict::TooLittle),
        (
            "silences that the bus does not call silence yet",
            line(&[MotorFindings {
                silent: false,
                ..standing(ID, tally(15, 15, 0))
            }]),
            Verdict::TooLittle,
        ),
        ("four of garbage", alone(tally(4, 0, 4)), Verdict::TooLittle),
        ("few replies", alone(tally(39, 0, 0)), Verdict::TooLittle),
        (
            "replies of one motor, and few of another",
            line(&[standing(ID, good), standing(two(), tally(20, 0, 0))]),
            Verdict::TooLittle,
        ),
        (
            "a header that knows of more losses",
            line(&[MotorFindings {
                loss_per_mille: Some(50),
                ..standing(ID, good)
            }]),
            Verdict::LossEnded,
        ),
        (
            "a motor that has just fallen silent",
            line(&[MotorFindings {
                heard: tally(550, 3, 0),
                quiet: tally(40, 40, 0),
                ..standing(ID, tally(590, 43, 0))
            }]),
            Verdict::TooLittle,
        ),
        ("a good line", alone(good), Verdict::Healthy),
        (
            "one of a hundred lost",
            alone(tally(100, 1, 0)),
            Verdict::Healthy,
        ),
        (
            "three of a hundred lost",
            alone(tally(100, 1, 2)),
            Verdict::SomeLoss,
        ),
        (
            "one of a hundred, for long",
            alone(tally(600, 3, 3)),
            Verdict::Healthy,
        ),
        ("a bad start", alone(tally(20, 4, 0)), Verdict::TooLittle),
        (
            "one of a hundred damaged, all while it turned",
            line(&[moving(tally(100, 0, 0), tally(600, 0, 6))]),
            Verdict::Healthy,
        ),
        (
            "two late replies",
            Findings {
                foreign: 2,
                ..alone(good)
            },
            Verdict::Healthy,
        ),
        (
            "a common adapter",
            with_median(2_400, alone(good)),
            Verdict::Healthy,
        ),
        (
            "a busy machine",
            with_median(9_000, alone(good)),
            Verdict::Healthy,
        ),
        (
            "an echo before every reply",
            alone(Tally {
                echoed: 100,
                ..good
            }),
            Verdict::Healthy,
        ),
    ] {
        assert_eq!(diagnose(&findings), expected, "{name}");
    }
}
