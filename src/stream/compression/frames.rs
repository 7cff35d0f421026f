//! zstd frames (RFC 8878), in contexts that are used again.

use std::alloc::{Layout, handle_alloc_error};

use zstd::zstd_safe::zstd_sys::ZSTD_EndDirective as End;
use zstd::zstd_safe::{
    CCtx, CParameter, DCtx, InBuffer, OutBuffer, ParamSwitch, ResetDirective, compress_bound,
    find_frame_compressed_size,
};

use super::Fault;

/// First bytes of a zstd frame.
const MAGIC: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];
/// The largest window of a frame that is well-formed.
const WINDOW_MAX: u64 = 1 << 23;
/// The level for tokens: they have hardly any repetitions to look for.
const TOKENS_LEVEL: i32 = -5;
/// The level for records.
const RECORDS_LEVEL: i32 = 3;
/// Fewer bytes than this get no block of the frame of their own.
const SEGMENT_MIN: usize = 64;
/// Bytes that a block of the frame adds at most.
const SEGMENT_HEAD: usize = 16;
/// Settings do not depend on the input.
const SOUND: &str = "zstd takes these settings";

/// Compresses bytes into frames.
#[derive(Default)]
pub(super) struct Packer {
    context: Option<CCtx<'static>>,
    frame: Vec<u8>,
}

impl Packer {
    /// A frame of tokens. `cuts` are places in the tokens, in order, where their distribution changes: zstd
    /// gets the pieces between them as blocks with Huffman codes of their own.
    pub(super) fn tokens(&mut self, tokens: &[u8], cuts: &[usize]) -> &[u8] {
        let context = start(&mut self.context, TOKENS_LEVEL, tokens.len());
        // Fast levels leave literals as they are, but all that is to be won here is in their Huffman codes.
        context.set_parameter(CParameter::LiteralCompressionMode(ParamSwitch::Enable)).expect(SOUND);
        reserve(&mut self.frame, compress_bound(tokens.len()) + SEGMENT_HEAD * cuts.len());
        let mut output = OutBuffer::around(&mut self.frame);
        let mut done = 0;
        for &cut in cuts {
            if cut >= done + SEGMENT_MIN && cut + SEGMENT_MIN <= tokens.len() {
                write(context, &mut output, &tokens[done..cut], End::ZSTD_e_flush);
                done = cut;
            }
        }
        write(context, &mut output, &tokens[done..], End::ZSTD_e_end);
        &self.frame
    }

    /// A frame of any bytes.
    pub(super) fn records(&mut self, bytes: &[u8]) -> &[u8] {
        let context = start(&mut self.context, RECORDS_LEVEL, bytes.len());
        reserve(&mut self.frame, compress_bound(bytes.len()));
        write(context, &mut OutBuffer::around(&mut self.frame), bytes, End::ZSTD_e_end);
        &self.frame
    }
}

/// Starts a frame of `len` bytes.
fn start<'c>(context: &'c mut Option<CCtx<'static>>, level: i32, len: usize) -> &'c mut CCtx<'static> {
    let context = context.get_or_insert_with(|| CCtx::try_create().unwrap_or_else(|| out_of_memory()));
    context.reset(ResetDirective::SessionAndParameters).expect(SOUND);
    context.set_parameter(CParameter::CompressionLevel(level)).expect(SOUND);
    context.set_pledged_src_size(Some(len as u64)).expect(SOUND);
    context
}

fn reserve(frame: &mut Vec<u8>, len: usize) {
    frame.clear();
    frame.reserve(len + SEGMENT_MIN);
}

fn write(context: &mut CCtx, output: &mut OutBuffer<Vec<u8>>, bytes: &[u8], end: End) {
    let mut input = InBuffer::around(bytes);
    // There is room for the frame, so only the memory of zstd itself can be lacking.
    while context.compress_stream2(output, &mut input, end).unwrap_or_else(|_| out_of_memory()) != 0 {}
}

/// Ends the program as an allocation does that fails.
fn out_of_memory() -> ! {
    handle_alloc_error(Layout::new::<[u8; 1 << 20]>())
}

/// Decompresses frames.
#[derive(Default)]
pub(super) struct Unpacker {
    context: Option<DCtx<'static>>,
    content: Vec<u8>,
}

impl Unpacker {
    /// The content of the one frame that `frame` is, at most `len_max` bytes.
    pub(super) fn unpack(&mut self, frame: &[u8], len_max: usize) -> Result<&[u8], Fault> {
        let is_one = frame.starts_with(&MAGIC)
            && find_frame_compressed_size(frame).is_ok_and(|len| len == frame.len());
        if !is_one {
            return Err("not one zstd frame");
        }
        if window(frame) > WINDOW_MAX {
            return Err("a zstd frame with a window above 2^23 bytes");
        }
        self.content.clear();
        self.content.reserve_exact(len_max);
        let create = || DCtx::try_create().unwrap_or_else(|| out_of_memory());
        let context = self.context.get_or_insert_with(create);
        let len = context.decompress(&mut self.content, frame);
        match len {
            Ok(len) if len <= len_max => Ok(&self.content),
            _ => Err("the zstd frame is damaged, or its content is too long"),
        }
    }
}

/// The window that a frame states (RFC 8878, section 3.1.1.1.2). A frame of one segment states none: its window is
/// its content.
fn window(frame: &[u8]) -> u64 {
    const SINGLE_SEGMENT: u8 = 1 << 5;
    match frame[MAGIC.len()..] {
        [descriptor, window, ..] if descriptor & SINGLE_SEGMENT == 0 => {
            let base = 1 << (10 + (window >> 3));
            base + base / 8 * u64::from(window & 7)
        }
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_hold_what_was_put_into_them() {
        let (mut packer, mut unpacker) = (Packer::default(), Unpacker::default());
        for len in [0, 1, 100, 5_000, 1 << 20] {
            let bytes: Vec<u8> = (0..len).map(|i| (i * i / 128) as u8).collect();
            let cuts = [len / 3, len / 2, len];
            let frame = packer.tokens(&bytes, &cuts).to_vec();
            assert_eq!(unpacker.unpack(&frame, len), Ok(&bytes[..]));
            assert_eq!(unpacker.unpack(packer.records(&bytes), len), Ok(&bytes[..]));
            if len > 0 {
                unpacker.unpack(&frame, len - 1).unwrap_err();
            }
        }
    }

    #[test]
    fn one_frame_is_asked_for() {
        let (mut packer, mut unpacker) = (Packer::default(), Unpacker::default());
        let frame = packer.records(&[7; 100]).to_vec();
        let skippable = [&[0x50, 0x2a, 0x4d, 0x18, 0, 0, 0, 0][..], &frame].concat();
        for bytes in [&[][..], &frame[..frame.len() - 1], &[&frame[..], &frame].concat(), &skippable] {
            assert_eq!(unpacker.unpack(bytes, 1000), Err("not one zstd frame"));
        }
    }
}
