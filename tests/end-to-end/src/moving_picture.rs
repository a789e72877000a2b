//! Animated WebP files of a page. The browser draws, scales and encodes the frames.
//!
//! This module only writes the container around them (RFC 9649), a few bytes per frame, so that no encoder has to be
//! built for one picture.

use std::{
    fs,
    path::Path,
    thread,
    time::{Duration, Instant},
};

use anyhow::{Context, Result, bail};
use serde_json::json;

use crate::page::Page;
use crate::view::View;

/// One picture, as encoded by the browser, and its time.
struct Shot {
    webp: Vec<u8>,
    at: Duration,
}

impl Page {
    /// Records a window of this view for `length` in `count` pictures, scaled to `width`. Each picture is shown for
    /// the time until the next one, so the speed is realistic.
    ///
    /// # Errors
    ///
    /// When a picture cannot be taken or encoded, or the file not written.
    pub fn record_webp(
        &self,
        view: View,
        width: u32,
        count: u32,
        length: Duration,
        file: &Path,
    ) -> Result<()> {
        // Drawn at the final size: scaling a large picture takes the browser a third of a second.
        let metrics = json!({
            "width": view.width,
            "height": view.height,
            "deviceScaleFactor": f64::from(width) / f64::from(view.width),
            "mobile": false,
        });
        self.session
            .call("Emulation.setDeviceMetricsOverride", metrics)?;
        let began = Instant::now();
        let mut shots = Vec::new();
        for number in 0..count {
            let due = length * number / count;
            thread::sleep(due.saturating_sub(began.elapsed()));
            let at = began.elapsed();
            let webp = self.picture_webp(70)?;
            shots.push(Shot { webp, at });
        }
        let end = began.elapsed().max(length);
        let size = (width, view.height * width / view.width);
        fs::write(file, animated(&shots, end, size)?)
            .with_context(|| format!("cannot write {}", file.display()))
    }
}

/// The file: RIFF, the header of an endless animation, and its frames.
fn animated(shots: &[Shot], end: Duration, size: (u32, u32)) -> Result<Vec<u8>> {
    const ANIMATED: u32 = 0b10;
    let mut body = b"WEBP".to_vec();
    let mut header = ANIMATED.to_le_bytes().to_vec();
    header.extend(less_one(size.0)?);
    header.extend(less_one(size.1)?);
    put_chunk(&mut body, *b"VP8X", &header)?;
    // Background, which the pictures cover, and number of repeats: 0 is endless.
    put_chunk(&mut body, *b"ANIM", &[0; 6])?;
    let ends = shots.iter().skip(1).map(|next| next.at).chain([end]);
    for (shot, until) in shots.iter().zip(ends) {
        let shown_ms = u32::try_from(until.saturating_sub(shot.at).as_millis())?;
        let mut frame = vec![0; 6];
        frame.extend(less_one(size.0)?);
        frame.extend(less_one(size.1)?);
        frame.extend(three_bytes(shown_ms)?);
        // It replaces the previous picture.
        frame.push(0b10);
        frame.extend(image_of(&shot.webp).context("the browser's picture is no lossy WebP")?);
        put_chunk(&mut body, *b"ANMF", &frame)?;
    }
    let mut file = Vec::new();
    put_chunk(&mut file, *b"RIFF", &body)?;
    Ok(file)
}

/// The chunk of a WebP file that holds the image, whole.
fn image_of(webp: &[u8]) -> Option<&[u8]> {
    let mut rest = webp.get(12..)?;
    loop {
        let length: [u8; 4] = rest.get(4..8)?.try_into().ok()?;
        let length = usize::try_from(u32::from_le_bytes(length)).ok()?;
        let (chunk, after) = rest.split_at_checked(8 + length.next_multiple_of(2))?;
        if chunk.starts_with(b"VP8 ") {
            return Some(chunk);
        }
        rest = after;
    }
}

/// Writes name, length and content, which is padded to an even length.
fn put_chunk(file: &mut Vec<u8>, name: [u8; 4], content: &[u8]) -> Result<()> {
    file.extend(name);
    file.extend(u32::try_from(content.len())?.to_le_bytes());
    file.extend(content);
    file.resize(file.len().next_multiple_of(2), 0);
    Ok(())
}

fn less_one(pixels: u32) -> Result<[u8; 3]> {
    three_bytes(pixels.saturating_sub(1))
}

fn three_bytes(number: u32) -> Result<[u8; 3]> {
    let [low, middle, high, over] = number.to_le_bytes();
    if over == 0 {
        Ok([low, middle, high])
    } else {
        bail!("{number} does not fit into three bytes")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_as_the_format_has_it() {
        let webp = b"RIFF\x12\0\0\0WEBPVP8 \x05\0\0\0abcde\0".to_vec();
        let shots = [0, 125].map(|ms| Shot {
            webp: webp.clone(),
            at: Duration::from_millis(ms),
        });
        let file = animated(&shots, Duration::from_millis(250), (960, 600)).unwrap();
        assert_eq!(file.len(), 8 + 4 + 18 + 14 + 2 * (8 + 16 + 14));
        assert_eq!(&file[..8], b"RIFF\x70\0\0\0");
        assert_eq!(
            &file[8..30],
            b"WEBPVP8X\x0A\0\0\0\x02\0\0\0\xBF\x03\0\x57\x02\0"
        );
        assert_eq!(&file[44..52], b"ANMF\x1E\0\0\0");
        // Position, size, 125 ms, and the image.
        assert_eq!(
            &file[52..68],
            b"\0\0\0\0\0\0\xBF\x03\0\x57\x02\0\x7D\0\0\x02"
        );
        assert_eq!(&file[68..82], b"VP8 \x05\0\0\0abcde\0");
    }

    #[test]
    fn what_is_no_picture_is_refused() {
        assert!(image_of(b"RIFF").is_none());
        assert!(image_of(b"RIFF\x12\0\0\0WEBPVP8 \xFF\0\0\0abcde\0").is_none());
    }
}
