"""What a run stands on besides its physics: processes, messages, streams, the cache of compiled forms."""
