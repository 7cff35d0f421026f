//! Words in a temporary file, written and read in order.

use std::path::{Path, PathBuf};

use spmesh_base::error::Result;
use spmesh_base::temporary::TemporaryFile;

/// Words that wait to be written, or are read at a time. There may be two hundred files.
const BUFFER_LEN: usize = 1 << 12;

/// What is done, in messages.
const WRITING: &str = "writing cells";
const READING: &str = "reading cells back";

/// A file of words, which exists only if there are more than fit the buffer.
#[derive(Debug)]
pub(super) struct WordFile {
    folder: Option<PathBuf>,
    file: Option<TemporaryFile>,
    written: u64,
    buffer: Vec<u32>,
}

impl WordFile {
    /// No words yet; the file will be in `folder`, or in the system's folder for temporary files.
    pub(super) fn new(folder: Option<&Path>) -> WordFile {
        WordFile { folder: folder.map(Path::to_path_buf), file: None, written: 0, buffer: Vec::new() }
    }

    /// Adds words.
    #[inline(always)]
    pub(super) fn extend(&mut self, words: &[u32]) -> Result<()> {
        if self.buffer.len() + words.len() > BUFFER_LEN {
            self.flush()?;
        }
        self.buffer.extend_from_slice(words);
        Ok(())
    }

    #[cold]
    fn flush(&mut self) -> Result<()> {
        let file = match &mut self.file {
            Some(file) => file,
            none => none.insert(TemporaryFile::create(self.folder.as_deref())?),
        };
        file.append(WRITING, bytemuck::cast_slice(&self.buffer))?;
        self.written += self.buffer.len() as u64;
        self.buffer.clear();
        Ok(())
    }

    /// All words, in order.
    pub(super) fn into_words(self) -> Result<Vec<u32>> {
        let mut reader = self.into_reader()?;
        reader.fill(reader.unread as usize)?;
        Ok(reader.words)
    }

    /// Reads the words from the first on.
    pub(super) fn into_reader(mut self) -> Result<WordReader> {
        if self.file.is_some() {
            self.flush()?;
        }
        let WordFile { file, written, buffer, .. } = self;
        Ok(WordReader { file, unread: written, offset: 0, words: buffer, at: 0 })
    }
}

/// Reads words in order.
#[derive(Debug)]
pub(super) struct WordReader {
    file: Option<TemporaryFile>,
    /// Words of the file that were not read yet, and the place of the first of them in bytes.
    unread: u64,
    offset: u64,
    words: Vec<u32>,
    /// Words that were taken of these.
    at: usize,
}

impl WordReader {
    /// The next list, which begins with a word that gives its length in the bits of `mask`; `None` after the
    /// last.
    #[inline(always)]
    pub(super) fn list(&mut self, mask: u32) -> Result<Option<(u32, usize)>> {
        if self.at == self.words.len() && !self.fill(1)? {
            return Ok(None);
        }
        let first = self.words[self.at];
        let length = (first & mask) as usize;
        if self.words.len() - self.at <= length {
            self.fill(length + 1)?;
        }
        self.at += length + 1;
        Ok(Some((first, length)))
    }

    /// The words of the list that was read last.
    #[inline(always)]
    pub(super) fn last(&self, length: usize) -> &[u32] {
        &self.words[self.at - length..self.at]
    }

    /// Reads on until so many words can be taken; whether there are any.
    #[cold]
    fn fill(&mut self, count: usize) -> Result<bool> {
        self.words.drain(..self.at);
        self.at = 0;
        let (kept, wanted) = (self.words.len(), count.max(BUFFER_LEN) as u64);
        let read = (wanted - kept as u64).min(self.unread);
        self.words.resize(kept + read as usize, 0);
        if let Some(file) = &self.file {
            file.read_at(READING, bytemuck::cast_slice_mut(&mut self.words[kept..]), self.offset)?;
        }
        self.offset += 4 * read;
        self.unread -= read;
        Ok(!self.words.is_empty())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_come_out_as_they_went_in() {
        for count in [0, 1, 100, 5 * BUFFER_LEN as u32 + 7] {
            let lists = || (0..count).map(|i| (0..i % 7).map(move |j| i + j).collect::<Vec<u32>>());
            let [mut as_words, mut as_lists] = [WordFile::new(None), WordFile::new(None)];
            for list in lists() {
                let marked = [&[list.len() as u32 | 1 << 31], &list[..]].concat();
                as_words.extend(&marked).unwrap();
                as_lists.extend(&marked[..1]).unwrap();
                as_lists.extend(&list).unwrap();
            }
            assert_eq!(as_words.file.is_some(), count > 100);
            let words = as_words.into_words().unwrap();
            assert_eq!(words.len(), lists().map(|list| list.len() + 1).sum::<usize>());
            let mut reader = as_lists.into_reader().unwrap();
            let mut all = Vec::new();
            for list in lists() {
                let (first, length) = reader.list(i32::MAX as u32).unwrap().unwrap();
                assert_eq!((first, reader.last(length)), (list.len() as u32 | 1 << 31, &list[..]));
                all.extend([&[first], reader.last(length)].concat());
            }
            assert!(reader.list(i32::MAX as u32).unwrap().is_none());
            assert_eq!(all, words);
        }
    }
}
