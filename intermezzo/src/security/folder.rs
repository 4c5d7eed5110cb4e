//! Files that are nobody else's business.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use crate::exit::Failure;

/// A folder for this user alone, and what is to be in it.
pub(crate) struct Folder<'a> {
    path: &'a Path,
    /// Whether what is there may be replaced.
    force: bool,
    files: Vec<(String, String)>,
    /// A file that people write in. If it is replaced, it is kept under another name.
    edited: Option<String>,
}

impl<'a> Folder<'a> {
    pub(crate) fn new(path: &'a Path, force: bool) -> Self {
        Self {
            path,
            force,
            files: Vec::new(),
            edited: None,
        }
    }

    /// One more file, that people write in.
    pub(crate) fn put_edited(&mut self, name: impl Into<String>, text: impl Into<String>) {
        let name = name.into();
        self.edited = Some(name.clone());
        self.put(name, text);
    }

    /// One more file.
    pub(crate) fn put(&mut self, name: impl Into<String>, text: impl Into<String>) {
        self.files.push((name.into(), text.into()));
    }

    /// Writes all of them, each readable by this user alone. Returns where what people had written is
    /// now, if it was replaced.
    ///
    /// # Errors
    /// If one of them is there and may not be replaced; then nothing was written.
    pub(crate) fn write(self) -> Result<Option<PathBuf>, Failure> {
        if !self.force {
            let mut paths = self.files.iter().map(|(name, _)| self.path.join(name));
            if let Some(there) = paths.find(|path| path.exists()) {
                return Err(exists(&there));
            }
        }
        make(self.path)?;
        let kept = self.keep_edited()?;
        for (name, text) in &self.files {
            let path = self.path.join(name);
            let failed = |error: std::io::Error| cannot("write", &path, &error);
            // Made readable by its owner alone, and complete before it has its name.
            let mut file = NamedTempFile::new_in(self.path).map_err(failed)?;
            file.write_all(text.as_bytes()).map_err(failed)?;
            file.as_file().sync_all().map_err(failed)?;
            let persisted = if self.force {
                file.persist(&path)
            } else {
                file.persist_noclobber(&path)
            };
            persisted.map_err(|error| failed(error.error))?;
        }
        Ok(kept)
    }

    fn keep_edited(&self) -> Result<Option<PathBuf>, Failure> {
        let Some(name) = &self.edited else {
            return Ok(None);
        };
        let path = self.path.join(name);
        let (_, new) = match self.files.iter().find(|(file, _)| file == name) {
            Some(file) if path.exists() => file,
            _ => return Ok(None),
        };
        if read(&path)? == *new {
            return Ok(None);
        }
        let kept = self.path.join(format!("{name}.before"));
        fs::rename(&path, &kept).map_err(|error| cannot("keep", &path, &error))?;
        Ok(Some(kept))
    }
}

/// Makes a folder for this user alone, if it is not there.
fn make(path: &Path) -> Result<(), Failure> {
    let mut builder = fs::DirBuilder::new();
    builder.recursive(true);
    #[cfg(unix)]
    {
        use std::os::unix::fs::DirBuilderExt;
        builder.mode(0o700);
    }
    builder
        .create(path)
        .map_err(|error| cannot("make", path, &error))
}

/// A file's text.
pub(crate) fn read(path: &PathBuf) -> Result<String, Failure> {
    fs::read_to_string(path).map_err(|error| cannot("read", path, &error))
}

fn cannot(what: &str, path: &Path, error: &std::io::Error) -> Failure {
    Failure::bad_input(format_args!("cannot {what} {}: {error}", path.display()))
}

fn exists(path: &Path) -> Failure {
    Failure::bad_input(format_args!("{} is there already", path.display())).advice(
        "another folder; or --add NAME for one user more; or --force to replace what is there, which locks out whoever has the old files",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn nobody_else_can_read_what_is_written_and_nothing_is_replaced_unasked() {
        use std::os::unix::fs::PermissionsExt;
        let parent = tempfile::tempdir().unwrap();
        let path = parent.path().join("keys");
        let write = |text: &str, force: bool| {
            let mut folder = Folder::new(&path, force);
            folder.put("new", "new");
            folder.put("a", text);
            folder.write()
        };
        write("first", false).unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
        assert_eq!(mode(&path), 0o700);
        assert_eq!(mode(&path.join("a")), 0o600);
        fs::remove_file(path.join("new")).unwrap();
        let refused = write("second", false).unwrap_err();
        assert!(refused.what.contains("is there already"), "{refused:?}");
        assert!(!path.join("new").exists(), "nothing was written");
        assert_eq!(read(&path.join("a")).unwrap(), "first");
        assert_eq!(write("third", true).unwrap(), None);
        assert_eq!(read(&path.join("a")).unwrap(), "third");
        assert_eq!(mode(&path.join("a")), 0o600);
        assert_eq!(
            fs::read_dir(&path).unwrap().count(),
            2,
            "nothing is left over"
        );
    }
    #[test]
    fn what_people_have_written_is_kept_when_it_is_replaced() {
        let parent = tempfile::tempdir().unwrap();
        let path = parent.path();
        let write = || {
            let mut folder = Folder::new(path, true);
            folder.put_edited("rules", "ours");
            folder.write().unwrap()
        };
        assert_eq!(write(), None);
        assert_eq!(write(), None, "nobody has written anything");
        fs::write(path.join("rules"), "theirs").unwrap();
        let kept = write().unwrap();
        assert_eq!(read(&kept).unwrap(), "theirs");
        assert_eq!(read(&path.join("rules")).unwrap(), "ours");
    }
}
