"""Run: /usr/bin/python3 -m unittest discover -s report/tests -t report"""
