"""The paper on trial: each number and claim of Rahmani and Ervin (2014) beside what is computed here."""
