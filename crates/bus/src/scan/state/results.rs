//! What a scan has found so far, and how much of it is left.

use std::{collections::VecDeque, time::Duration};

use motorlink_protocol::{Instant, MotorId};

use super::{EXCHANGES_WANTED, PASSES_ON_A_BAD_LINE, Scan};
use crate::{
    job::status::JobStatus,
    scan::{
        address::{ADDRESSES, Address, place},
        report::{ScanFault, ScanReport},
    },
    timing::SCAN_SAMPLING_MAX,
};

/// So many addresses that are still noisy are asked again: more are no late bytes of a busy machine. With six probes of
/// 50 ms each they take 2.4 s.
const SECOND_LOOKS_MAX: usize = 8;

/// So few windows with a byte 00 or FF are chance.
const LEVEL_WINDOWS_MIN: u16 = 20;

impl Scan {
    pub(crate) fn status(&self) -> JobStatus {
        let micros = |duration: Duration| u64::try_from(duration.as_micros()).unwrap_or(u64::MAX);
        let probes = self.queue.len() as u64;
        let samples = if self.lost == 0 && !self.found.is_empty() {
            u64::from(EXCHANGES_WANTED.saturating_sub(self.exchanges))
        } else {
            0
        };
        let passes = u64::from(self.passes().saturating_sub(self.pass)) * u64::from(ADDRESSES);
        let sampling = (samples * micros(self.reply_times.usual())).min(micros(SCAN_SAMPLING_MAX));
        let left_us = (probes + passes) * micros(self.reply_times.window()) + sampling;
        JobStatus::Scanning {
            asked: self.asked,
            of: ADDRESSES,
            left_ms: u32::try_from(left_us / 1000).unwrap_or(u32::MAX),
            found: self.found.clone(),
        }
    }

    pub(crate) fn report(&self, now: Instant, complete: bool) -> ScanReport {
        ScanReport {
            found: self.found.clone(),
            noisy: self.noisy(),
            fault: self.fault(),
            asked: self.asked,
            complete,
            took_ms: u32::try_from(now.since(self.began).as_millis()).unwrap_or(u32::MAX),
        }
    }

    pub(super) fn fault(&self) -> Option<ScanFault> {
        if self.is_behind_blocks() {
            return Some(ScanFault::Blocks);
        }
        let floats = self.level_windows >= LEVEL_WINDOWS_MIN && self.found.is_empty();
        floats.then_some(ScanFault::Floating)
    }

    /// Whether the adapter delivers only full blocks, so that no reply comes in its window.
    pub(super) fn is_behind_blocks(&self) -> bool {
        self.only_blocks == Some(true)
    }

    /// Passes over the silent addresses: one more for every lost reply, since a line that loses one
    /// in twenty loses several during the measurement. If no motor is found but the ID query had an
    /// answer, a motor is missing.
    pub(super) fn passes(&self) -> u8 {
        if self.is_behind_blocks() {
            return 1;
        }
        if self.found.is_empty() && self.id_query_answered {
            return PASSES_ON_A_BAD_LINE;
        }
        let again = u8::try_from(self.lost).unwrap_or(u8::MAX);
        again.saturating_add(1).min(PASSES_ON_A_BAD_LINE)
    }

    pub(super) fn noisy<C: FromIterator<MotorId>>(&self) -> C {
        self.where_address(|address| !address.is_found() && !address.is_silent())
    }

    /// Addresses that are noisy after all probes, if they are few. They get as many probes again.
    pub(super) fn look_again(&mut self) -> VecDeque<MotorId> {
        let noisy: VecDeque<MotorId> = self.noisy();
        if noisy.len() > SECOND_LOOKS_MAX {
            return VecDeque::new();
        }
        for id in &noisy {
            if let Some(address) = self.addresses.get_mut(place(*id)) {
                address.probes = 0;
            }
        }
        noisy
    }

    pub(super) fn silent(&self) -> VecDeque<MotorId> {
        self.where_address(Address::is_silent)
    }

    pub(super) fn doubtful(&self) -> VecDeque<MotorId> {
        self.where_address(Address::is_doubtful)
    }

    fn where_address<C: FromIterator<MotorId>>(&self, is: impl Fn(Address) -> bool) -> C {
        let asked = MotorId::all().zip(&self.addresses);
        asked
            .filter(|(_, address)| address.probes > 0 && is(**address))
            .map(|(id, _)| id)
            .collect()
    }
}
