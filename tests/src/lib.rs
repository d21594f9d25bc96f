//! Shared by the tests that span crates: the program under test, test scenes, comparers.
