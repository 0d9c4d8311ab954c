"""Loaded first by worker processes of this machine: Ctrl-C in their terminal is for the process that started
them, which ends them."""
import signal

signal.signal(signal.SIGINT, signal.SIG_IGN)
