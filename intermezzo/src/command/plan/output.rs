//! Where a plan goes: into a file, whole or not at all, or to the standard output.

use std::fs::{self, File, Permissions};
use std::io::{self, BufWriter, Write};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

use tempfile::{Builder, NamedTempFile};

use crate::exit::Failure;

/// A file that is going to be written, and that can be as far as anybody knows.
pub(super) struct Target {
    /// As it was typed.
    named: PathBuf,
    /// What that is, if it is a link.
    file: PathBuf,
    /// A terminal, a pipe, `/dev/null`: cannot be replaced, only written to.
    special: bool,
}

impl Target {
    /// Planning may take an hour: what is wrong with the file is better said before.
    pub(super) fn new(named: &Path) -> Result<Self, Failure> {
        let file = fs::canonicalize(named).unwrap_or_else(|_| named.to_owned());
        let metadata = fs::metadata(&file).ok();
        let target = Self {
            named: named.to_owned(),
            special: metadata.is_some_and(|metadata| !metadata.is_file()),
            file,
        };
        let tried = if target.special {
            File::options().write(true).open(&target.file).map(|_| ())
        } else {
            target.temporary().map(|_| ())
        };
        tried.map_err(|error| {
            Failure::bad_input(target.cannot(&error)).advice("name a file that you may write")
        })?;
        Ok(target)
    }

    /// Writes all of it, and only then lets it be seen.
    pub(super) fn write(
        self,
        content: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>,
    ) -> Result<(), Failure> {
        let written = if self.special {
            let file = File::options().write(true).open(&self.file);
            file.and_then(|file| filled(&file, content))
        } else {
            self.temporary().and_then(|temporary| {
                filled(temporary.as_file(), content)?;
                temporary.as_file().sync_all()?;
                temporary.persist(&self.file)?;
                Ok(())
            })
        };
        written.map_err(|error| {
            Failure::failed(self.cannot(&error)).advice("name a file elsewhere, or make room")
        })
    }

    /// Beside the file, so that it can take its place.
    fn temporary(&self) -> io::Result<NamedTempFile> {
        let folder = self.file.parent();
        let folder = folder.filter(|folder| !folder.as_os_str().is_empty());
        // The process's mask takes from this what others shall not do.
        Builder::new()
            .prefix(".plan")
            .permissions(Permissions::from_mode(0o666))
            .tempfile_in(folder.unwrap_or(Path::new(".")))
    }

    fn cannot(&self, error: &io::Error) -> String {
        // Without the temporary file's name, which says nothing to whoever typed another one.
        let error = error.to_string();
        let error = error.split(" at path ").next().unwrap_or(&error);
        format!("cannot write {}: {error}", self.named.display())
    }
}

fn filled(
    file: &File,
    content: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>,
) -> io::Result<()> {
    let mut out = BufWriter::with_capacity(1 << 16, file);
    content(&mut out)?;
    out.flush()
}

/// Writes to the standard output. Whoever reads that may have seen enough: `… | head`.
pub(super) fn print(
    content: impl FnOnce(&mut BufWriter<io::StdoutLock<'static>>) -> io::Result<()>,
) -> Result<(), Failure> {
    let mut out = BufWriter::with_capacity(1 << 16, io::stdout().lock());
    match content(&mut out).and_then(|()| out.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        Err(error) => Err(Failure::failed(format_args!(
            "cannot print the plan: {error}"
        ))),
        Ok(()) => Ok(()),
    }
}
