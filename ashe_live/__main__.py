"""`ashe-live` and `python -m ashe_live`."""

from ashe_live.process import main

if __name__ == "__main__":
    main()
