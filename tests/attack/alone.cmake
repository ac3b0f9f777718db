# Read by ctest after the tests of attack_test are known. Fifty thousand datagrams a second fill a core, and a server that
# waits a tenth of a second for one beside other tests loses those of honest clients, too: then they join late.
set_tests_properties(net.DoorAttackTest.AFloodOfRequestsKeepsNobodyOut PROPERTIES RUN_SERIAL ON)
