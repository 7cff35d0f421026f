//! Opens an input by its format.

use std::path::Path;

use crate::detect::{DD4, Format, read_head};
use crate::source::gzip::Use;
use crate::source::origin::Origin;
use crate::volumes::scan::Supply;
use crate::volumes::volume::Volume;
use crate::volumes::{nifti, nrrd, stream, text};
use spmesh_base::error::{Error, Result};

/// Recognizes the format of `origin` and reads its header; `path` is the file's path, if it has one.
pub(crate) fn open(origin: Origin, path: Option<&Path>, warnings: &mut Vec<String>) -> Result<Supply> {
    let mut plain = origin.plain()?;
    let head = read_head(&mut plain).map_err(|e| Error::io("reading", e))?;
    if head.is_empty() {
        return Err(Error::malformed("found no point"));
    }
    match DD4.detect(&head)? {
        Format::Nrrd => nrrd::open(origin, path, warnings).map(boxed),
        Format::Nifti => nifti::open(origin, &head, plain.is_compressed(), warnings).map(boxed),
        Format::Stream | Format::Twin => stream::open(origin, path, &head).map(Supply::Stream),
        _ => text::open(origin.of_use(Use::Held)).map(Supply::Text),
    }
}

fn boxed(volume: Volume) -> Supply {
    Supply::Volume(Box::new(volume))
}
