#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# fleet_keys.sh FOLDER DOMAIN NAME...: keys for DDS security, for robots, map agents and watches of these names in a fleet
# domain. Writes an authority, which stays with you, and for each name a folder to copy to its computer; its cyclonedds.xml
# goes into CYCLONEDDS_URI. An authority that is there is used again.
set -euo pipefail

if (($# < 3)) || ! [[ $2 =~ ^[0-9]+$ ]] || (($2 > 232)); then
  echo "fleet_keys.sh: expected FOLDER DOMAIN NAME..., with a domain of 0 ... 232" >&2
  exit 2
fi
folder=$1 domain=$2
shift 2
for name in "$@"; do
  if ! [[ $name =~ ^[a-z][a-z0-9_]{0,31}$ ]]; then
    echo "fleet_keys.sh: found the name $name, expected up to 32 of a-z, 0-9 and _, beginning with a letter" >&2
    exit 2
  fi
done

umask 077
mkdir -p "$folder"
cd "$folder"
days=3650
new_key() { openssl ecparam -name prime256v1 -genkey -noout -out "$1"; }
signed() { openssl smime -sign -in "$1" -text -out "$2" -signer authority.crt -inkey authority.key; }

if [[ ! -f authority.key ]]; then
  new_key authority.key
  openssl req -x509 -key authority.key -subj /CN=fleet -days $days -out authority.crt
fi
cat > governance.xml <<END
<?xml version="1.0" encoding="UTF-8"?>
<dds><domain_access_rules><domain_rule>
  <domains><id>$domain</id></domains>
  <allow_unauthenticated_participants>false</allow_unauthenticated_participants>
  <enable_join_access_control>true</enable_join_access_control>
  <discovery_protection_kind>ENCRYPT</discovery_protection_kind>
  <liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>
  <rtps_protection_kind>NONE</rtps_protection_kind>
  <topic_access_rules><topic_rule>
    <topic_expression>*</topic_expression>
    <enable_discovery_protection>true</enable_discovery_protection>
    <enable_liveliness_protection>true</enable_liveliness_protection>
    <enable_read_access_control>true</enable_read_access_control>
    <enable_write_access_control>true</enable_write_access_control>
    <metadata_protection_kind>ENCRYPT</metadata_protection_kind>
    <data_protection_kind>NONE</data_protection_kind>
  </topic_rule></topic_access_rules>
</domain_rule></domain_access_rules></dds>
END
signed governance.xml governance.p7s

for name in "$@"; do
  mkdir -p "$name"
  [[ -f $name/key.pem ]] || new_key "$name/key.pem"
  openssl req -new -key "$name/key.pem" -subj "/CN=$name" |
    openssl x509 -req -CA authority.crt -CAkey authority.key -CAcreateserial -days $days -out "$name/certificate.pem" 2> /dev/null
  # The subject without blanks, or Cyclone does not find it.
  cat > "$name/permissions.xml" <<END
<?xml version="1.0" encoding="UTF-8"?>
<dds><permissions><grant name="$name">
  <subject_name>CN=$name</subject_name>
  <validity><not_before>2020-01-01T00:00:00</not_before><not_after>2100-01-01T00:00:00</not_after></validity>
  <allow_rule>
    <domains><id>$domain</id></domains>
    <publish><topics><topic>*</topic></topics></publish>
    <subscribe><topics><topic>*</topic></topics></subscribe>
  </allow_rule>
  <default>DENY</default>
</grant></permissions></dds>
END
  signed "$name/permissions.xml" "$name/permissions.p7s"
  rm "$name/permissions.xml"
  cp authority.crt governance.p7s "$name"
  here=$(cd "$name" && pwd)
  cat > "$name/cyclonedds.xml" <<END
<!-- CYCLONEDDS_URI=file://$here/cyclonedds.xml; change the folder where the files are copied elsewhere -->
<CycloneDDS><Domain Id="$domain"><Security>
  <Authentication>
    <Library finalizeFunction="finalize_authentication" initFunction="init_authentication" path="dds_security_auth"/>
    <IdentityCA>file:$here/authority.crt</IdentityCA>
    <IdentityCertificate>file:$here/certificate.pem</IdentityCertificate>
    <PrivateKey>file:$here/key.pem</PrivateKey>
  </Authentication>
  <AccessControl>
    <Library finalizeFunction="finalize_access_control" initFunction="init_access_control" path="dds_security_ac"/>
    <PermissionsCA>file:$here/authority.crt</PermissionsCA>
    <Governance>file:$here/governance.p7s</Governance>
    <Permissions>file:$here/permissions.p7s</Permissions>
  </AccessControl>
  <Cryptographic>
    <Library finalizeFunction="finalize_crypto" initFunction="init_crypto" path="dds_security_crypto"/>
  </Cryptographic>
</Security></Domain></CycloneDDS>
END
  echo "$here"
done
