//! Why a scene is refused: the file, the object in it, the value, and what to do next.

use std::fmt;
use std::path::{Path, PathBuf};

/// A refused scene.
#[derive(Debug, thiserror::Error)]
#[error("{}: {}{fault}; {}", file.display(), prefix(object), fault.next_step())]
pub struct LoadError {
    /// The file at fault: the scene, or a file that it or the settings name.
    pub file: PathBuf,
    /// Place in the file, for example `meshes[2].primitives[0].attributes.POSITION`; empty when the whole file is at fault.
    pub object: String,
    /// What is wrong there.
    #[source]
    pub fault: Fault,
}

fn prefix(object: &str) -> String {
    if object.is_empty() { String::new() } else { format!("{object} ") }
}

/// What is wrong with a place in a file. The messages continue a sentence that begins with the place.
#[derive(Debug, thiserror::Error)]
pub enum Fault {
    /// The file cannot be read.
    #[error("cannot be read ({0})")]
    Unreadable(#[from] std::io::Error),
    /// The bytes are no glTF or GLB file.
    #[error("is no glTF 2.0 file: {0}")]
    Container(String),
    /// The JSON part does not parse or lacks a required field.
    #[error("is not what glTF expects there: {0}")]
    Json(String),
    /// An index refers to an object that does not exist.
    #[error("refers to {list}[{index}], but the file has {count} {list}")]
    Reference {
        /// Name of the array referred into.
        list: &'static str,
        /// The index found.
        index: u64,
        /// Entries that the array has.
        count: usize,
    },
    /// A value outside what is allowed.
    #[error("is {value}, allowed is {allowed}")]
    Value {
        /// The value found.
        value: String,
        /// The allowed range or set.
        allowed: String,
    },
    /// More bytes are needed than are there.
    #[error("needs {needed} bytes of {of}, which has {present}")]
    Bounds {
        /// Bytes needed.
        needed: u64,
        /// What the bytes are taken from.
        of: String,
        /// Bytes there.
        present: u64,
    },
    /// A required extension that this program does not know.
    #[error("requires the extension {name}, which bake does not support")]
    RequiredExtension {
        /// Name of the extension.
        name: String,
    },
    /// A feature that this program does not handle.
    #[error("is {what}, which bake does not support")]
    Unsupported {
        /// What was met.
        what: String,
        /// The way out.
        way_out: &'static str,
    },
    /// Compressed data that does not decode.
    #[error("holds {format} data that does not decode ({reason})")]
    Decode {
        /// Name of the format.
        format: &'static str,
        /// What the decoder said.
        reason: String,
    },
    /// Decoded data would be out of proportion to the file.
    #[error("would take {needed} bytes, more than the {allowed} that files of this size may take")]
    TooLarge {
        /// Bytes asked for.
        needed: u64,
        /// Bytes left of the allowance.
        allowed: u64,
    },
    /// A node is its own ancestor, or has two parents.
    #[error("is reached a second time from {parent}: nodes must form trees")]
    NotATree {
        /// The second parent.
        parent: String,
    },
    /// There is nothing to bake.
    #[error("has no triangles in scene {scene}")]
    NoTriangles {
        /// Name or index of the scene.
        scene: String,
    },
    /// Nothing shines.
    #[error("has no light: no punctual light, no emissive material, no sky")]
    NoLight,
}

impl Fault {
    /// What the user can do about it.
    pub fn next_step(&self) -> &str {
        match self {
            Self::Unreadable(_) => "check the path and its permissions",
            Self::Container(_) => "export the scene again as .glb or .gltf",
            Self::Json(_) | Self::Reference { .. } | Self::NotATree { .. } => {
                "correct the file or export it again; the Khronos glTF validator lists every such place"
            }
            Self::Value { .. } => "correct the value, or export the file again",
            Self::Bounds { .. } => "the file is cut short or its sizes are wrong: export or copy it again",
            Self::RequiredExtension { .. } => {
                "export without it, or convert the file with a tool that knows it (gltf-transform, Blender)"
            }
            Self::Unsupported { way_out, .. } => way_out,
            Self::Decode { .. } => "export or convert that data again",
            Self::TooLarge { .. } => "the sizes in the file are wrong: export it again",
            Self::NoTriangles { .. } => "choose another scene with `--scene`, or export meshes made of triangles",
            Self::NoLight => "give it one: `--sky r,g,b` (cd/m²), `--sun` or `--env FILE`, or add lights to the scene",
        }
    }

    /// A value outside what is allowed.
    pub(super) fn value(value: impl fmt::Display, allowed: impl Into<String>) -> Self {
        Self::Value { value: value.to_string(), allowed: allowed.into() }
    }

    /// Attaches the place in the scene file.
    pub(super) fn at(self, place: &Place) -> Refusal {
        Refusal { file: None, object: place.to_string(), fault: self }
    }

    /// Attaches another file than the scene's.
    pub(super) fn in_file(self, file: &Path) -> Refusal {
        Refusal { file: Some(file.to_owned()), object: String::new(), fault: self }
    }
}

/// A fault with its place; the loader adds the scene's path.
#[derive(Debug)]
pub(super) struct Refusal {
    file: Option<PathBuf>,
    object: String,
    fault: Fault,
}

impl Refusal {
    /// The public error; `scene` is the file unless another one is at fault.
    pub fn into_error(self, scene: &Path) -> LoadError {
        LoadError { file: self.file.unwrap_or_else(|| scene.to_owned()), object: self.object, fault: self.fault }
    }

    /// The message without the scene's path, for faults that are only warned about.
    pub fn reason(&self) -> String {
        match &self.file {
            Some(file) => format!("{}: {}", file.display(), self.fault),
            None => self.fault.to_string(),
        }
    }

    /// Names the place within another file.
    pub fn object(mut self, object: impl Into<String>) -> Self {
        self.object = object.into();
        self
    }
}

/// A place in the JSON document, kept as a chain on the stack so that naming places costs nothing until one is at fault.
#[derive(Clone, Copy)]
pub(super) struct Place<'a> {
    parent: Option<&'a Place<'a>>,
    name: &'a str,
    index: Option<usize>,
}

impl<'a> Place<'a> {
    /// A top-level field.
    pub const fn root(name: &'a str) -> Self {
        Self { parent: None, name, index: None }
    }

    /// An entry of a top-level array.
    pub const fn entry(list: &'a str, index: usize) -> Self {
        Self { parent: None, name: list, index: Some(index) }
    }

    /// A field of this object; a dotted path is fine.
    pub const fn field(&'a self, name: &'a str) -> Place<'a> {
        Place { parent: Some(self), name, index: None }
    }

    /// An entry of an array field of this object.
    pub const fn item(&'a self, name: &'a str, index: usize) -> Place<'a> {
        Place { parent: Some(self), name, index: Some(index) }
    }
}

impl fmt::Display for Place<'_> {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        if let Some(parent) = self.parent {
            write!(out, "{parent}.")?;
        }
        out.write_str(self.name)?;
        self.index.map_or(Ok(()), |index| write!(out, "[{index}]"))
    }
}

/// Looks an index up in one of the document's arrays.
pub(super) fn lookup<'a, T>(list: &'a [T], name: &'static str, index: u32, place: &Place) -> Result<&'a T, Refusal> {
    list.get(index as usize)
        .ok_or_else(|| Fault::Reference { list: name, index: index.into(), count: list.len() }.at(place))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_reads_as_a_json_path() {
        let mesh = Place::entry("meshes", 2);
        let primitive = mesh.item("primitives", 0);
        assert_eq!(primitive.field("attributes.POSITION").to_string(), "meshes[2].primitives[0].attributes.POSITION");
    }

    #[test]
    fn the_message_names_file_object_value_and_next_step() {
        let error =
            Fault::value(7, "0 to 6").at(&Place::entry("meshes", 1).field("mode")).into_error(Path::new("a.glb"));
        let text = error.to_string();
        for part in ["a.glb", "meshes[1].mode", "is 7", "0 to 6", "export"] {
            assert!(text.contains(part), "{part} missing in: {text}");
        }
    }
}
