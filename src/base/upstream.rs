//! What a program that fails tells the next one in a pipe, so that both end with the same exit code and only
//! the first one says why.
//!
//! A program that fails while its output goes to a pipe writes a mark as its last bytes ([`mark`]). It is no
//! part of a format: the output before it is cut off, and malformed as such. A program that fails and has read
//! a mark at the end of stdin takes over its exit code ([`failure`]).

use std::io::{self, Read};
use std::os::fd::{AsFd, BorrowedFd};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU8, Ordering};

use rustix::fs::{FileType, fstat};

/// Bytes of a mark.
const MARK_LEN: usize = 20;
/// Where the three digits of the exit code are.
const DIGITS: std::ops::Range<usize> = 16..19;

/// The last bytes read from stdin.
static TAIL: Mutex<[u8; MARK_LEN]> = Mutex::new([0; MARK_LEN]);

/// Whether a failure is marked on stdout: [`UNDECIDED`], [`MARKED`] or [`UNMARKED`].
static STDOUT: AtomicU8 = AtomicU8::new(UNDECIDED);
/// No output was opened.
const UNDECIDED: u8 = 0;
/// Stdout is a pipe, and gets binary data.
const MARKED: u8 = 1;
/// Stdout is no output, is no pipe, gets text, or has the mark.
const UNMARKED: u8 = 2;

/// The mark of an exit code: a line such as `spmesh: failed 001`.
pub fn mark(code: u8) -> [u8; MARK_LEN] {
    let mut mark = *b"\nspmesh: failed 000\n";
    for (digit, unit) in mark[DIGITS].iter_mut().zip([100, 10, 1]) {
        *digit += code / unit % 10;
    }
    mark
}

/// Says that an output was opened; that it `is_binary_stdout` decides, whatever else is opened.
pub(crate) fn output_is_open(is_binary_stdout: bool) {
    if is_binary_stdout && is_pipe(io::stdout()) {
        STDOUT.store(MARKED, Ordering::Relaxed);
    } else {
        let _ = STDOUT.compare_exchange(UNDECIDED, UNMARKED, Ordering::Relaxed, Ordering::Relaxed);
    }
}

/// Says that stdout will get binary data if no output is opened before the program fails.
pub fn expect_binary_stdout() {
    if STDOUT.load(Ordering::Relaxed) == UNDECIDED {
        output_is_open(true);
    }
}

/// Says that the output is whole, whatever comes after it.
pub fn output_is_whole() {
    STDOUT.store(UNMARKED, Ordering::Relaxed);
}

/// Writes the mark of `code` if binary data go to a pipe. It makes one system call, which a signal handler may
/// make.
pub fn mark_failure(code: u8) {
    if STDOUT.swap(UNMARKED, Ordering::Relaxed) == MARKED {
        // A reader that is gone needs no mark.
        let _ = rustix::io::write(rustix::stdio::stdout(), &mark(code));
    }
}

/// Whether `stream` is a pipe or a socket.
pub fn is_pipe(stream: impl AsFd) -> bool {
    let kind = fstat(stream).map(|status| FileType::from_raw_mode(status.st_mode));
    matches!(kind, Ok(FileType::Fifo | FileType::Socket))
}

/// Stdin, whose last bytes are remembered.
#[derive(Debug)]
pub struct Watched<R>(pub R);

impl<R: Read> Read for Watched<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let len = self.0.read(bytes)?;
        remember(&bytes[..len]);
        Ok(len)
    }
}

impl<R: AsFd> AsFd for Watched<R> {
    fn as_fd(&self) -> BorrowedFd<'_> {
        self.0.as_fd()
    }
}

fn remember(bytes: &[u8]) {
    let Ok(mut tail) = TAIL.lock() else { return };
    let kept = bytes.len().min(MARK_LEN);
    tail.rotate_left(kept);
    tail[MARK_LEN - kept..].copy_from_slice(&bytes[bytes.len() - kept..]);
}

/// The exit code of the program before this one in the pipe, if stdin ended with its mark.
///
/// A reader may stop within the mark; then the rest of it is read.
pub fn failure() -> Option<u8> {
    let started = code_of(&TAIL.lock().ok()?[..]);
    let Err(missing) = started else { return started.ok() };
    let mut rest = [0; MARK_LEN];
    if missing == MARK_LEN || io::stdin().read_exact(&mut rest[..missing]).is_err() {
        return None;
    }
    remember(&rest[..missing]);
    code_of(&TAIL.lock().ok()?[..]).ok()
}

/// The code of a mark at the end of `tail`; if there is none, how many bytes would complete one.
fn code_of(tail: &[u8]) -> Result<u8, usize> {
    let is_like =
        |found: &[u8]| {
            let blank = mark(0);
            let places = found.iter().zip(blank).enumerate();
            places.into_iter().all(|(place, (&byte, blank))| {
                if DIGITS.contains(&place) { byte.is_ascii_digit() } else { byte == blank }
            })
        };
    let len = (1..=MARK_LEN).rev().find(|&len| is_like(&tail[MARK_LEN - len..])).unwrap_or(0);
    if len < MARK_LEN {
        return Err(MARK_LEN - len);
    }
    let code = tail[DIGITS].iter().fold(0u32, |code, digit| 10 * code + u32::from(digit - b'0'));
    u8::try_from(code).map_err(|_| MARK_LEN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_found_at_the_end_only() {
        assert_eq!(&mark(141), b"\nspmesh: failed 141\n");
        assert_eq!(code_of(&mark(7)), Ok(7));
        let mut tail = mark(3);
        tail[MARK_LEN - 1] = b'x';
        assert_eq!(code_of(&tail), Err(MARK_LEN));
        let cut = [&[b'x'; 12][..], &mark(3)[..8]].concat();
        assert_eq!(code_of(&cut), Err(12));
        assert_eq!(code_of(b"\nspmesh: failed 999\n"), Err(MARK_LEN));
    }
}
