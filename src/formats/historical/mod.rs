//! Formats of earlier streaming software: SPA, SPB, SMA and SMB (`formats/historical.md`).

pub(crate) mod cell_index;
pub(crate) mod read_sma;
pub(crate) mod read_smb;
pub(crate) mod read_spa;
pub(crate) mod read_spb;
pub(crate) mod smb_header;
pub(crate) mod sp;
pub(crate) mod sp_cells;
pub(crate) mod sp_events;
pub(crate) mod write_cells;
pub(crate) mod write_sma;
pub(crate) mod write_smb;
pub(crate) mod write_spa;
pub(crate) mod write_spb;
