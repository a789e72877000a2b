//! A long run keeps every motor and every kind of reply, at a lower rate.

use motorlink_experiments::runner::{Record, RecordPart, Sample};
use motorlink_protocol::{Instant, MotorId};

fn reply(id: u8, at_us: u64, celsius: Option<u8>) -> Sample {
    Sample {
        id: MotorId::new(id).unwrap(),
        at: Instant::from_micros(at_us),
        rpm: Some(100),
        current: None,
        degrees: celsius.is_none().then_some(1.0),
        celsius,
    }
}

fn record(samples: impl Iterator<Item = Sample>) -> Record {
    let mut record = Record::default();
    record.add_part(RecordPart {
        samples: samples.collect(),
        ..RecordPart::default()
    });
    record
}

/// The times of the replies that a filter keeps, in seconds.
fn times(record: &Record, of: impl Fn(&Sample) -> bool) -> Vec<f64> {
    let kept = record.samples().iter().filter(|sample| of(sample));
    kept.map(|sample| sample.at.since(Instant::ZERO).as_secs_f64())
        .collect()
}

fn longest_gap_s(times: &[f64]) -> f64 {
    let gaps = times.windows(2).map(|pair| pair[1] - pair[0]);
    gaps.fold(0.0, f64::max)
}

#[test]
fn four_hours_at_50_hz_keep_their_temperatures() {
    // 50 drive frames and 10 queries a second.
    let ticks = 0..4 * 3_600 * 10_u64;
    let record = record(ticks.flat_map(|n| {
        let drive = (0..5).map(move |k| reply(1, n * 100_000 + k * 20_000, None));
        drive.chain([reply(1, n * 100_000 + 90_000, Some(40))])
    }));
    let warm = times(&record, |sample| sample.celsius.is_some());
    assert_eq!(warm.len(), 144_000);
    assert!(longest_gap_s(&warm) < 0.11);
    let angles = times(&record, |sample| sample.degrees.is_some());
    assert!(longest_gap_s(&angles) < 0.09, "{}", longest_gap_s(&angles));
    assert!(*angles.last().unwrap() > 14_399.9);
    assert!(record.samples().len() <= 400_000 && record.is_thinned());
}

#[test]
fn two_motors_at_200_hz_are_thinned_evenly() {
    let ticks = 0..3_600 * 200_u64;
    let record = record(ticks.flat_map(|n| {
        let of = move |id: u8| reply(id, n * 5_000 + u64::from(id) * 1_000, None);
        let query = (n % 20 == 7).then(|| reply(2, n * 5_000 + 4_000, Some(30)));
        [of(1), of(2)].into_iter().chain(query)
    }));
    for id in [1, 2] {
        let id = MotorId::new(id).unwrap();
        let kept = times(&record, |it| it.id == id && it.degrees.is_some());
        assert!(longest_gap_s(&kept) < 0.021, "{}", longest_gap_s(&kept));
    }
    let order = record.samples().windows(2);
    assert!(order.into_iter().all(|pair| pair[0].at < pair[1].at));
}
