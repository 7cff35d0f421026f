//! The one layer of compression: inputs that may be compressed with gzip or zstd, which their first bytes
//! tell.

use std::io::{self, BufRead, BufReader, Chain, Cursor, ErrorKind, Read};

use flate2::bufread::GzDecoder;

use spmesh_base::limits::{EXPANSION_FREE, EXPANSION_MAX};
use spmesh_base::system::expect_inflate_memory;
use spmesh_stream::ZstdReader;

/// First bytes of gzip data.
const MAGIC: [u8; 2] = [0x1f, 0x8b];

/// First bytes of zstd data.
const ZSTD_MAGIC: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];

/// Bytes read at once.
const BUFFER_LEN: usize = 1 << 17;

/// An input whose first bytes were read to recognize it.
type Whole<R> = Chain<Cursor<Vec<u8>>, R>;

/// The plain bytes of an input, compressed with gzip, zstd or not.
///
/// Damaged or truncated data is an error of kind [`ErrorKind::InvalidData`] that names the byte.
pub struct Plain<R: Read> {
    inner: Inner<R>,
}

enum Inner<R: Read> {
    AsIs(Whole<R>),
    Gzip(Box<Gunzip<Whole<R>>>),
    Zstd(Box<Unzstd<Whole<R>>>),
}

impl<R: Read> Plain<R> {
    /// Looks at the first bytes of `input`.
    ///
    /// # Errors
    /// If reading fails.
    pub fn new(input: R) -> io::Result<Self> {
        Plain::of_use(input, Use::Passed)
    }

    /// As [`Plain::new`], for a caller that holds what it reads: atoms, vertices, polygons. Records of them
    /// differ, so that gzip data which expands implausibly is an error of kind [`ErrorKind::InvalidData`].
    ///
    /// # Errors
    /// If reading fails.
    pub fn held(input: R) -> io::Result<Self> {
        Plain::of_use(input, Use::Held)
    }

    pub(crate) fn of_use(mut input: R, purpose: Use) -> io::Result<Self> {
        let mut start = Vec::new();
        (&mut input).take(ZSTD_MAGIC.len() as u64).read_to_end(&mut start)?;
        let (is_gzip, is_zstd) = (start.starts_with(&MAGIC), start == ZSTD_MAGIC);
        let whole = Cursor::new(start).chain(input);
        let inner = match (is_gzip, is_zstd) {
            (true, _) => Inner::Gzip(Box::new(Gunzip::of_use(whole, purpose))),
            (_, true) => Inner::Zstd(Box::new(Unzstd::of_use(whole, purpose)?)),
            _ => Inner::AsIs(whole),
        };
        Ok(Plain { inner })
    }

    /// Whether the input is compressed.
    pub fn is_compressed(&self) -> bool {
        !matches!(self.inner, Inner::AsIs(_))
    }
}

impl<R: Read> Read for Plain<R> {
    #[inline]
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match &mut self.inner {
            Inner::AsIs(input) => input.read(buffer),
            Inner::Gzip(input) => input.read(buffer),
            Inner::Zstd(input) => input.read(buffer),
        }
    }
}

/// What a caller does with the bytes that it reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Use {
    /// It forgets them, so that they may be any number.
    Passed,
    /// It keeps memory for each record of them.
    Held,
}

/// Decompresses gzip data of any number of members. Damaged data is an error that names the byte.
///
/// The checksum and the length of a member are verified when reading goes on after its last byte.
pub(crate) struct Gunzip<R> {
    /// `None` only while the next member begins.
    member: Option<Member<R>>,
    purpose: Use,
    /// Decompressed bytes so far.
    expanded: u64,
}

/// Decompresses one member.
type Member<R> = GzDecoder<BufReader<Counted<R>>>;

impl<R: Read> Gunzip<R> {
    pub(crate) fn new(input: R) -> Self {
        Gunzip::of_use(input, Use::Passed)
    }

    fn of_use(input: R, purpose: Use) -> Self {
        expect_inflate_memory();
        let input = BufReader::with_capacity(BUFFER_LEN, Counted { input, bytes: 0, failed: false });
        Gunzip { member: Some(GzDecoder::new(input)), purpose, expanded: 0 }
    }

    fn member(&mut self) -> &mut Member<R> {
        self.member.as_mut().expect("a member is there between reads")
    }

    fn read_on(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            let read = self.member().read(buffer)?;
            if read > 0 || buffer.is_empty() || skip_zeros(self.member().get_mut())? {
                return Ok(read);
            }
            self.member = self.member.take().map(|ended| GzDecoder::new(ended.into_inner()));
        }
    }

    /// Compressed bytes that were used.
    fn consumed(&mut self) -> u64 {
        let input = self.member().get_ref();
        input.get_ref().bytes - input.buffer().len() as u64
    }

    /// Checks that what a caller holds may be records that differ.
    fn check_expansion(&mut self) -> io::Result<()> {
        let (expanded, consumed) = (self.expanded, self.consumed());
        check_expansion(expanded, consumed, ["gzip", "gunzip"])
    }

    /// Names the byte of the compressed data where decompression failed, and makes the error
    /// [`ErrorKind::InvalidData`]. Errors of reading stay as they are.
    #[cold]
    fn locate(&mut self, error: io::Error) -> io::Error {
        if self.member().get_ref().get_ref().failed {
            return error;
        }
        let byte = self.consumed();
        damaged(&error, "gzip", byte)
    }
}

/// Checks that what a caller holds may be records that differ. `names` are those of the format and of the
/// program that decompresses it.
fn check_expansion(expanded: u64, consumed: u64, names: [&str; 2]) -> io::Result<()> {
    if !is_implausible(expanded, consumed) {
        return Ok(());
    }
    let (ratio, [format, program]) = (expanded / consumed.max(1), names);
    let message = format!(
        "{consumed} bytes of {format} data expand to {expanded}, {ratio} times as many: records that differ \
         expand at most {EXPANSION_MAX}-fold; if the file is right, decompress it with {program} first"
    );
    Err(io::Error::new(ErrorKind::InvalidData, message))
}

/// An error of decompression at a byte of the compressed data.
fn damaged(error: &io::Error, format: &str, byte: u64) -> io::Error {
    let found = match error.kind() {
        ErrorKind::UnexpectedEof => "ends early: it was cut off, or other bytes follow it,".to_string(),
        _ => format!("is damaged ({error})"),
    };
    io::Error::new(ErrorKind::InvalidData, format!("the {format} data {found} at byte {byte} of the file"))
}

/// Decompresses zstd data of any number of frames, as [`Gunzip`] does gzip data.
struct Unzstd<R: Read> {
    frames: ZstdReader<BufReader<Counted<R>>>,
    purpose: Use,
    /// Decompressed bytes so far.
    expanded: u64,
}

impl<R: Read> Unzstd<R> {
    fn of_use(input: R, purpose: Use) -> io::Result<Self> {
        let input = BufReader::with_capacity(BUFFER_LEN, Counted { input, bytes: 0, failed: false });
        Ok(Unzstd { frames: ZstdReader::new(input)?, purpose, expanded: 0 })
    }

    /// Compressed bytes that were used.
    fn consumed(&self) -> u64 {
        let input = self.frames.input();
        input.get_ref().bytes - input.buffer().len() as u64
    }
}

impl<R: Read> Read for Unzstd<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.frames.read(buffer).map_err(|error| {
            let is_own = error.kind() == ErrorKind::Interrupted || self.frames.input().get_ref().failed;
            if is_own { error } else { damaged(&error, "zstd", self.consumed()) }
        })?;
        self.expanded += read as u64;
        if self.purpose == Use::Held {
            check_expansion(self.expanded, self.consumed(), ["zstd", "unzstd"])?;
        }
        Ok(read)
    }
}

impl<R: Read> Read for Gunzip<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.read_on(buffer).map_err(|e| match e.kind() {
            ErrorKind::Interrupted => e,
            _ => self.locate(e),
        })?;
        self.expanded += read as u64;
        if self.purpose == Use::Held {
            self.check_expansion()?;
        }
        Ok(read)
    }
}

/// Whether gzip data that expands like this cannot be records that differ.
fn is_implausible(expanded: u64, compressed: u64) -> bool {
    expanded > EXPANSION_FREE && expanded > EXPANSION_MAX.saturating_mul(compressed)
}

/// Skips zeros, with which tapes and block devices fill up their last block (gzip(1) ignores them too). True
/// if the input ends after them.
fn skip_zeros(input: &mut impl BufRead) -> io::Result<bool> {
    loop {
        let bytes = input.fill_buf()?;
        if bytes.is_empty() {
            return Ok(true);
        }
        let zeros = bytes.iter().take_while(|byte| **byte == 0).count();
        if zeros == 0 {
            return Ok(false);
        }
        input.consume(zeros);
    }
}

/// Counts the bytes that are read, and remembers whether reading itself failed.
struct Counted<R> {
    input: R,
    bytes: u64,
    failed: bool,
}

impl<R: Read> Read for Counted<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let result = self.input.read(buffer);
        match &result {
            Ok(len) => self.bytes += *len as u64,
            Err(e) => self.failed |= e.kind() != ErrorKind::Interrupted,
        }
        result
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::Compression;
    use flate2::write::GzEncoder;
    use spmesh_base::random::Random;

    use super::*;

    fn packed(parts: &[&[u8]]) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
        parts.iter().for_each(|part| encoder.write_all(part).unwrap());
        encoder.finish().unwrap()
    }

    /// The length of the plain bytes, or the message.
    fn held(packed: &[u8]) -> Result<u64, String> {
        let mut plain = Plain::held(packed).unwrap();
        io::copy(&mut plain, &mut io::sink()).map_err(|error| error.to_string())
    }

    #[test]
    fn expansion_has_two_sides() {
        let [free, most] = [EXPANSION_FREE, EXPANSION_MAX];
        assert!(!is_implausible(free, 0) && is_implausible(free + 1, 0));
        assert!(!is_implausible(most * free, free) && is_implausible(most * free + 1, free));
        assert_eq!(held(&packed(&[&vec![b'1'; free as usize]])), Ok(free));
        let message = held(&packed(&[&vec![b'1'; free as usize + 1]])).unwrap_err();
        assert!(message.contains("at most 100-fold") && message.contains("gunzip"), "{message}");
    }

    /// What does not compress makes room for what does.
    #[test]
    fn the_ratio_is_that_of_all_so_far() {
        let mut random = Random::new(7);
        let noise: Vec<u8> = (0..50_000).map(|_| random.bits() as u8).collect();
        let repeated = vec![b'1'; 4_000_000];
        let mut both = packed(&[&noise, &repeated]);
        assert_eq!(held(&both), Ok(4_050_000));
        assert!(held(&packed(&[&repeated, &noise])).is_err());
        assert!(held(&packed(&[&noise, &repeated, &repeated])).is_err());
        // Members count together, and damage stays damage.
        both.extend(packed(&[&repeated]));
        assert!(held(&both).unwrap_err().contains("-fold"));
        let damaged = packed(&[&noise]);
        assert!(held(&damaged[..40_000]).unwrap_err().contains("ends early"));
    }

    /// Programs that pass bytes on take any ratio.
    #[test]
    fn what_is_passed_on_may_expand() {
        let repeated = vec![0; 10_000_000];
        let bomb = packed(&[&repeated]);
        assert_eq!(io::copy(&mut Plain::new(&bomb[..]).unwrap(), &mut io::sink()).unwrap(), 10_000_000);
    }
}
