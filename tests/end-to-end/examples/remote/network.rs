//! A network between two namespaces of this computer that delays each packet, and loses some.
//!
//! It does what `netem` does, which not every kernel has. TCP at both ends is that of the kernel.

use std::{
    collections::BTreeMap,
    fs::File,
    path::Path,
    process::Command,
    sync::{Arc, Mutex, PoisonError, mpsc},
    thread,
    time::{Duration, Instant},
};

use anyhow::{Context, Result, ensure};
use end_to_end::now_us;
use rustix::thread::{LinkNameSpaceType, move_into_link_name_space};
use tun_rs::{DeviceBuilder, SyncDevice};

/// Longer than any packet.
const PACKET_MAX: usize = 65_536;

/// How a network treats packets, each way.
#[derive(Clone, Copy, Debug)]
pub struct Quality {
    pub delay: Duration,
    pub loss_percent: u64,
}

/// Two namespaces with a network between them. They are removed when it is dropped.
pub struct Network {
    number: u8,
    /// What has arrived at the server.
    arrived: Arc<Mutex<Arrived>>,
}

/// When which part of a TCP stream had arrived without a gap.
#[derive(Default)]
struct Arrived {
    /// The sequence number of the first byte.
    first: Option<u32>,
    /// How many bytes from there have arrived without a gap.
    whole: u32,
    /// Parts behind a gap: from, to.
    parts: BTreeMap<u32, u32>,
    /// How many bytes were whole when.
    times: Vec<(u32, u64)>,
}

impl Network {
    pub fn start(number: u8, quality: Quality) -> Result<Self> {
        let network = Self {
            number,
            arrived: Arc::default(),
        };
        let server = network.device(&network.server_namespace(), &network.server_address())?;
        let viewer = network.device(&network.viewer_namespace(), &network.viewer_address())?;
        for (namespace, device, to) in [
            (
                network.server_namespace(),
                network.device_name("s"),
                network.viewer_address(),
            ),
            (
                network.viewer_namespace(),
                network.device_name("v"),
                network.server_address(),
            ),
        ] {
            ip(&format!("-n {namespace} route add {to} dev {device}"))?;
        }
        let (server, viewer) = (Arc::new(server), Arc::new(viewer));
        let arrived = Arc::clone(&network.arrived);
        carry(
            Arc::clone(&viewer),
            Arc::clone(&server),
            quality,
            1,
            move |packet| {
                let mut arrived = arrived.lock().unwrap_or_else(PoisonError::into_inner);
                arrived.take(packet);
            },
        );
        carry(server, viewer, quality, 2, |_| ());
        Ok(network)
    }

    fn device(&self, namespace: &str, address: &str) -> Result<SyncDevice> {
        let side = if namespace == self.server_namespace() {
            "s"
        } else {
            "v"
        };
        let name = self.device_name(side);
        if Path::new("/run/netns").join(namespace).exists() {
            // A killed run has left it.
            ip(&format!("netns del {namespace}"))?;
        }
        ip(&format!("netns add {namespace}"))?;
        let device = DeviceBuilder::new()
            .name(&name)
            .build_sync()
            .context("no TUN device: this needs root")?;
        ip(&format!("link set {name} netns {namespace}"))?;
        ip(&format!("-n {namespace} addr add {address}/32 dev {name}"))?;
        ip(&format!("-n {namespace} link set {name} up"))?;
        Ok(device)
    }

    fn device_name(&self, side: &str) -> String {
        format!("motorlink-{}{side}", self.number)
    }

    pub fn server_namespace(&self) -> String {
        format!("motorlink-server-{}", self.number)
    }

    fn viewer_namespace(&self) -> String {
        format!("motorlink-viewer-{}", self.number)
    }

    pub fn server_address(&self) -> String {
        format!("10.77.{}.1", self.number)
    }

    fn viewer_address(&self) -> String {
        format!("10.77.{}.2", self.number)
    }

    /// Moves this thread to the far end of the network.
    pub fn enter_as_viewer(&self) -> Result<()> {
        let path = format!("/run/netns/{}", self.viewer_namespace());
        let namespace = File::open(path)?;
        let kind = Some(LinkNameSpaceType::Network);
        move_into_link_name_space(rustix::fd::AsFd::as_fd(&namespace), kind)?;
        Ok(())
    }

    /// How many bytes of the newest connection the server has.
    pub fn arrived(&self) -> Option<u32> {
        let arrived = self.arrived.lock().unwrap_or_else(PoisonError::into_inner);
        arrived.times.last().map(|(whole, _)| *whole)
    }

    /// When the server had all of the first `bytes` of the newest connection, by [`now_us`].
    pub fn arrived_at(&self, bytes: u32) -> Option<u64> {
        let arrived = self.arrived.lock().unwrap_or_else(PoisonError::into_inner);
        let at = arrived.times.partition_point(|(whole, _)| *whole < bytes);
        arrived.times.get(at).map(|(_, at)| *at)
    }
}

impl Drop for Network {
    fn drop(&mut self) {
        for namespace in [self.server_namespace(), self.viewer_namespace()] {
            let _ = ip(&format!("netns del {namespace}"));
        }
    }
}

/// Carries packets one way until the device is gone.
fn carry(
    from: Arc<SyncDevice>,
    to: Arc<SyncDevice>,
    quality: Quality,
    seed: u64,
    mut has_arrived: impl FnMut(&[u8]) + Send + 'static,
) {
    let (queue, queued) = mpsc::channel::<(Instant, Vec<u8>)>();
    let mut random = seed;
    thread::spawn(move || {
        let mut packet = vec![0; PACKET_MAX];
        while let Ok(length) = from.recv(&mut packet) {
            if next(&mut random) % 100 < quality.loss_percent {
                continue;
            }
            let packet = packet.get(..length).unwrap_or_default().to_vec();
            let _ = queue.send((Instant::now() + quality.delay, packet));
        }
    });
    thread::spawn(move || {
        for (due, packet) in queued {
            thread::sleep(due.saturating_duration_since(Instant::now()));
            has_arrived(&packet);
            // The namespace is gone.
            let _ = to.send(&packet);
        }
    });
}

/// The next number of `SplitMix64`.
const fn next(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut mixed = *state;
    mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    mixed ^ (mixed >> 31)
}

impl Arrived {
    /// Takes a packet: IPv4 and TCP headers, and a part of the stream.
    fn take(&mut self, packet: &[u8]) {
        let Some((sequence, is_first, length)) = tcp(packet) else {
            return;
        };
        if is_first {
            *self = Self {
                first: Some(sequence.wrapping_add(1)),
                ..Self::default()
            };
        }
        let Some(first) = self.first.filter(|_| length > 0) else {
            return;
        };
        let from = sequence.wrapping_sub(first);
        let to = self.parts.entry(from).or_default();
        *to = (*to).max(from.wrapping_add(length));
        while let Some((&from, &to)) = self.parts.first_key_value()
            && from <= self.whole
        {
            self.parts.pop_first();
            self.whole = self.whole.max(to);
        }
        if self
            .times
            .last()
            .is_none_or(|(whole, _)| *whole < self.whole)
        {
            self.times.push((self.whole, now_us()));
        }
    }
}

/// The sequence number of a TCP packet, whether it is the first of its connection, and how many bytes it carries.
fn tcp(packet: &[u8]) -> Option<(u32, bool, u32)> {
    const TCP: u8 = 6;
    const SYN: u8 = 2;
    let head = usize::from(packet.first()? & 15) * 4;
    (*packet.get(9)? == TCP).then_some(())?;
    let segment = packet.get(head..)?;
    let sequence = u32::from_be_bytes(segment.get(4..8)?.try_into().ok()?);
    let segment_head = usize::from(segment.get(12)? >> 4) * 4;
    let is_first = segment.get(13)? & SYN != 0;
    let length = segment.len().checked_sub(segment_head)?;
    Some((sequence, is_first, u32::try_from(length).ok()?))
}

fn ip(line: &str) -> Result<()> {
    let status = Command::new("ip").args(line.split(' ')).status();
    ensure!(status.context("no `ip`")?.success(), "ip {line}");
    Ok(())
}
