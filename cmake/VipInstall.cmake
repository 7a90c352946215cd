# What the programs need at run time stands in share/vip-lab (base::resource finds it next to the program's bin/).
set(_share share/vip-lab)
install(DIRECTORY data/scenes data/meshes data/paper DESTINATION ${_share}/data)
install(FILES data/peers.csv DESTINATION ${_share}/data)
install(DIRECTORY shaders protocols docs DESTINATION ${_share})
install(DIRECTORY libstudy/store/sql DESTINATION ${_share}/libstudy/store)
