"""Runtime services without physics: processes, messages, streams, the cache of compiled forms."""
