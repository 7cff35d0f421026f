//! A temporary file that is complete: it is only read, in windows that are mapped instead of copied.

use std::fs::File;
use std::os::unix::fs::FileExt;

#[cfg(target_os = "linux")]
use memmap2::{Advice, Mmap, MmapOptions};

use super::TemporaryFile;
use crate::error::{Error, ErrorKind, Result};

/// Bytes that are mapped at a time; more, if more are wanted at once. Longer windows would only make the
/// process look larger.
#[cfg(target_os = "linux")]
const WINDOW_LEN: u64 = 1 << 20;

/// Windows start at multiples of this. The system allows multiples of its page size.
#[cfg(target_os = "linux")]
const ALIGNMENT: u64 = 1 << 16;

/// A file that no one writes to any more.
///
/// Invariant: nothing changes the bytes or the length. The file has no name, so that no other process opens
/// it. This type keeps the only descriptor, as [`TemporaryFile`] did before, which lent it to nobody: a copy
/// could be written to. And this type does not write.
#[derive(Debug)]
pub struct FrozenFile {
    file: File,
    name: String,
    len: u64,
}

impl TemporaryFile {
    /// The file, to be read only.
    ///
    /// # Errors
    /// If the system does not tell its length.
    pub fn freeze(self) -> Result<FrozenFile> {
        let len = self.file.metadata().map_err(|e| self.error("finding its length", e))?.len();
        Ok(FrozenFile { file: self.file, name: self.name, len })
    }
}

impl FrozenFile {
    /// Its name in messages.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Starts to read.
    pub fn windows(&self) -> Windows<'_> {
        Windows {
            file: self,
            #[cfg(target_os = "linux")]
            mapped: None,
            copied: Vec::new(),
        }
    }
}

/// Reads a file piece by piece. Pieces in ascending order cost least.
///
/// Memory: one window, in which the pages of the file count as memory of the process; or, where the system
/// does not map the file, a copy of the last piece.
#[derive(Debug)]
pub struct Windows<'f> {
    file: &'f FrozenFile,
    #[cfg(target_os = "linux")]
    mapped: Option<(u64, Mmap)>,
    copied: Vec<u8>,
}

impl Windows<'_> {
    /// `len` bytes from `offset` on; `what` describes the operation in messages.
    ///
    /// # Errors
    /// If the file cannot be read, or is too short.
    pub fn bytes(&mut self, what: &str, offset: u64, len: usize) -> Result<&[u8]> {
        if offset.checked_add(len as u64).is_none_or(|end| end > self.file.len) {
            let message = format!("{what}: {len} bytes at {offset} of a file of {} bytes", self.file.len);
            return Err(Error::new(ErrorKind::Io, message).of_input(&self.file.name));
        }
        #[cfg(target_os = "linux")]
        if let Some(start) = self.map(offset, len) {
            let mapped = self.mapped.as_ref().map_or(&[][..], |(_, mapped)| mapped);
            return Ok(&mapped[start..start + len]);
        }
        self.copied.resize(len, 0);
        let read = self.file.file.read_exact_at(&mut self.copied, offset);
        read.map_err(|e| Error::io(what, e).of_input(&self.file.name))?;
        Ok(&self.copied)
    }

    /// Makes the window hold `len` bytes from `offset` on, which are in the file, and tells where it has
    /// them. `None` if the system does not map the file, or cannot read it: reading will tell why.
    #[cfg(target_os = "linux")]
    fn map(&mut self, offset: u64, len: usize) -> Option<usize> {
        let is_held = |&(start, ref mapped): &(u64, Mmap)| {
            start <= offset && offset + len as u64 <= start + mapped.len() as u64
        };
        if !self.mapped.as_ref().is_some_and(is_held) {
            // Unmapped first, so that there are never two windows.
            self.mapped = None;
            let start = offset / ALIGNMENT * ALIGNMENT;
            let end = (start + WINDOW_LEN).max(offset + len as u64).min(self.file.len);
            let mut options = MmapOptions::new();
            options.offset(start).len(usize::try_from(end - start).ok()?);
            // SAFETY: by the invariant of the file, the bytes do not change while they are mapped, and all of
            // them lie within its length, so that no access is beyond the end. A page that the disk fails to
            // read would raise SIGBUS, too: all are read below, where such a failure is an error. Only if the
            // system drops a page, and its disk fails after that, a signal ends the process.
            let mapped = unsafe { options.map(&self.file.file) }.ok()?;
            mapped.advise(Advice::PopulateRead).ok()?;
            self.mapped = Some((start, mapped));
        }
        self.mapped.as_ref().map(|&(start, _)| (offset - start) as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn every_piece_of_a_frozen_file_is_what_was_written() {
        let bytes: Vec<u8> = (0..3_500_000u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
        let file = TemporaryFile::create(None).unwrap();
        file.write_at("writing", &bytes, 0).unwrap();
        let file = file.freeze().unwrap();
        let mut windows = file.windows();
        let mut random = Random::new(1);
        let mut check = |offset: usize, len: usize| {
            let found = windows.bytes("reading", offset as u64, len).unwrap();
            assert!(found == &bytes[offset..offset + len], "{len} bytes from {offset} on");
        };
        (0..bytes.len() / 10_000).for_each(|k| check(10_000 * k, 10_000));
        for _ in 0..300 {
            let offset = random.below(bytes.len() as u64) as usize;
            check(offset, random.below((bytes.len() - offset) as u64 + 1) as usize);
        }
        check(bytes.len(), 0);
    }

    #[test]
    fn bytes_beyond_the_end_are_an_error() {
        let file = TemporaryFile::create(None).unwrap();
        file.write_at("writing", &[1; 100], 0).unwrap();
        let file = file.freeze().unwrap();
        for (offset, len) in [(0, 101), (100, 1), (1 << 20, 1), (u64::MAX, 2)] {
            let error = file.windows().bytes("reading", offset, len).unwrap_err();
            assert_eq!(error.kind(), ErrorKind::Io);
        }
        assert_eq!(
            TemporaryFile::create(None).unwrap().freeze().unwrap().windows().bytes("", 0, 0).unwrap(),
            []
        );
    }
}
